//! Reasons to mistrust a solution.

use posecut_graph::PoseGraph;
use posecut_stage::{Context, Doubt, counted};

use super::figures::significant;
use crate::{ComponentReport, Solution};

/// Costs that differ by less than this, absolutely and as a share, are equal. They have no unit.
const SAME_COST: f64 = 1e-6;

/// Raises the warnings of a batch solution.
pub(super) fn of_solution<G>(graph: &PoseGraph, solution: &Solution<G>, context: &mut Context) {
    let components = &solution.components;
    doubt_disconnected(
        components.len(),
        components.iter().filter(|report| report.held == 0 && report.priors == 0).count(),
        context,
    );
    undetermined(graph, components, context);
    not_converged(graph, components, context);
    if !solution.chi_square.is_finite() {
        context.doubt(
            Doubt::NonFiniteCost,
            format!(
                "the squared residuals of {} overflow, and only their robust cost is finite ({}); reject edges \
                 with gross measurements, or give them moderate values",
                counted(solution.weights.len(), "edge"),
                significant(solution.cost)
            ),
        );
    }
    let lower: Vec<&ComponentReport> = components
        .iter()
        .filter(|report| report.cost - report.cost_given > SAME_COST * (1.0 + report.cost))
        .collect();
    if let [first, ..] = lower[..] {
        context.doubt(
            Doubt::NotCertified,
            format!(
                "the poses of the input cost less than the result in {} of {}: {} against {} in the first, that of node {}; the result \
                 is a local minimum, so try --initialisation given",
                lower.len(),
                counted(components.len(), "component"),
                significant(first.cost_given),
                significant(first.cost),
                graph.nodes[first.gauge].id
            ),
        );
    }
}

/// Warns that the relative poses of components are undetermined if `floating` of them have no fixed node.
pub fn doubt_disconnected(components: usize, floating: usize, context: &mut Context) {
    if components > 1 && floating > 0 {
        context.doubt(
            Doubt::PartsNotConnected,
            format!(
                "no edge in use connects the {components} components of the graph, and {floating} of them have no fixed node: each of these is \
                 optimised alone with its first node fixed, and the relative poses of components mean nothing; add or re-admit edges between them"
            ),
        );
    }
}

fn undetermined(graph: &PoseGraph, components: &[ComponentReport], context: &mut Context) {
    // If the priors of a component leave it free, its equations are singular, whatever rounding makes of them.
    let free: Vec<&ComponentReport> = components.iter().filter(|report| report.free).collect();
    if let [first, ..] = free[..] {
        context.doubt(
            Doubt::Undetermined,
            format!(
                "the priors do not determine how {} of {} {} turned (first: that of node {}), and damping keeps the rotation near that \
                 of the start; add the prior of a pose or of a further position, or fix a node",
                free.len(),
                counted(components.len(), "component"),
                if free.len() == 1 { "is" } else { "are" },
                graph.nodes[first.gauge].id
            ),
        );
    }
    let found: Vec<(usize, usize)> =
        components.iter().filter(|report| !report.free).filter_map(|report| report.undetermined).collect();
    if let [(node, axis), ..] = found[..] {
        context.doubt(
            Doubt::Undetermined,
            format!(
                "the edges do not determine all poses of {} of {} (first: component {axis} of the pose of node {}), and damping keeps \
                 such poses near their start; give the edges information in every direction",
                found.len(),
                counted(components.len(), "component"),
                graph.nodes[node].id
            ),
        );
    }
}

fn not_converged(graph: &PoseGraph, components: &[ComponentReport], context: &mut Context) {
    let found: Vec<&ComponentReport> =
        components.iter().filter(|report| !report.termination.converged()).collect();
    if let [first, ..] = found[..] {
        context.doubt(
            Doubt::NotConverged,
            format!(
                "{} of {} did not converge (first: that of node {}, {} after {}, cosine of the gradient {}); raise \
                 --max-iterations, start elsewhere (--initialisation) or check the information matrices",
                found.len(),
                counted(components.len(), "component"),
                graph.nodes[first.gauge].id,
                first.termination.name(),
                counted(first.iterations, "iteration"),
                significant(first.gradient)
            ),
        );
    }
}

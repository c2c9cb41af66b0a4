//! From a checked graph to its solution.

use posecut_geometry::{LieGroup, SE2, SE3};

use crate::components::{Component, connected_components};
use crate::initialisation::{chordal, spanning_tree};
use crate::kernel::charge;
use crate::levenberg_marquardt::Workspace;
use crate::normal_equations::Pattern;
use crate::options::{Initialisation, Options};
use crate::problem::{Edge, Problem};
use crate::residual::{chi2, cost, squared};
use crate::solution::{ComponentReport, Solution, Start, Termination};

/// A group of poses that can be optimised, with its chordal relaxation.
pub trait PoseGroup<const DOF: usize>: LieGroup<DOF> {
    /// Poses by rotations first, for a connected graph with its first pose given; `None` if the edges do not determine
    /// them.
    #[doc(hidden)]
    fn chordal_poses(pattern: &Relaxation<'_>, edges: &[Edge<Self, DOF>], first: &Self) -> Option<Vec<Self>>;
}

/// What the relaxation needs of the normal equations.
#[doc(hidden)]
#[derive(Debug)]
pub struct Relaxation<'a>(pub(crate) &'a Pattern);

impl PoseGroup<3> for SE2 {
    fn chordal_poses(pattern: &Relaxation<'_>, edges: &[Edge<Self, 3>], first: &Self) -> Option<Vec<Self>> {
        chordal::poses::<Self, 3, 2>(pattern.0, edges, first)
    }
}

impl PoseGroup<6> for SE3 {
    fn chordal_poses(pattern: &Relaxation<'_>, edges: &[Edge<Self, 6>], first: &Self) -> Option<Vec<Self>> {
        chordal::poses::<Self, 6, 3>(pattern.0, edges, first)
    }
}

/// Minimises the cost of a graph over its poses.
///
/// Every connected part is solved on its own, its first node staying at its given pose, whatever the start. Parts that
/// edges leave undetermined are damped and reported, not refused. The result depends on the input alone: sums have a
/// fixed order.
pub fn optimize<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    options: &Options,
) -> Solution<G> {
    let edges = problem.edges();
    let components =
        connected_components(problem.poses().len(), edges.iter().map(|edge| (edge.from, edge.to)));
    let mut poses = problem.poses().to_vec();
    let mut starts = poses.clone();
    let mut reports = Vec::with_capacity(components.len());
    let mut local = vec![0; poses.len()];
    for component in &components {
        for (index, &node) in component.nodes.iter().enumerate() {
            local[node] = index;
        }
        let part = extract(problem, component, &local);
        let (start, result, mut report) = solve_component(&part, options);
        report.gauge = component.nodes[0];
        report.undetermined = report.undetermined.map(|(node, axis)| (component.nodes[node], axis));
        for ((&node, start), pose) in component.nodes.iter().zip(start).zip(result) {
            starts[node] = start;
            poses[node] = pose;
        }
        reports.push(report);
    }
    let weights = edges.iter().map(|edge| charge(edge.kernel, squared(edge, &poses)).1).collect();
    Solution {
        chi2_given: chi2(problem, problem.poses()),
        chi2_initial: chi2(problem, &starts),
        chi2: chi2(problem, &poses),
        cost: cost(edges, &poses),
        iterations: reports.iter().map(|report| report.iterations).sum(),
        converged: reports.iter().all(|report| report.termination.converged()),
        weights,
        components: reports,
        poses,
    }
}

/// The part of the graph with its own numbering.
fn extract<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    component: &Component,
    local: &[usize],
) -> Problem<G, DOF> {
    let poses = component.nodes.iter().map(|&node| problem.poses()[node]).collect();
    let renumber = |edge: &Edge<G, DOF>| Edge { from: local[edge.from], to: local[edge.to], ..*edge };
    let edges = component.edges.iter().map(|&edge| renumber(&problem.edges()[edge])).collect();
    Problem::from_checked(poses, edges)
}

/// Start, result and report of a connected graph.
fn solve_component<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    options: &Options,
) -> (Vec<G>, Vec<G>, ComponentReport) {
    let edges = part.edges();
    let mut report = ComponentReport {
        gauge: 0,
        nodes: part.poses().len(),
        edges: edges.len(),
        cost_given: cost(edges, part.poses()),
        cost_start: 0.0,
        cost: 0.0,
        start: Start::Given,
        iterations: 0,
        rejected: 0,
        termination: Termination::NothingToDo,
        gradient: 0.0,
        undetermined: None,
        factor_blocks: 0,
    };
    if edges.is_empty() {
        return (part.poses().to_vec(), part.poses().to_vec(), report);
    }
    let pattern = Pattern::new(part.poses().len(), edges.iter().map(|edge| (edge.from, edge.to)), DOF);
    let (start, poses, cost_start) = choose_start(part, &pattern, options.initialisation);
    let mut result = poses.clone();
    let outcome = Workspace::new(&pattern).minimise(edges, &mut result, options);
    report.start = start;
    report.cost_start = cost_start;
    report.cost = outcome.cost;
    report.iterations = outcome.iterations;
    report.rejected = outcome.rejected;
    report.termination = outcome.termination;
    report.gradient = outcome.gradient;
    report.undetermined = outcome.undetermined;
    report.factor_blocks = pattern.symbolic.factor_blocks();
    (poses, result, report)
}

/// The start with the lowest cost among those asked for.
fn choose_start<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    pattern: &Pattern,
    initialisation: Initialisation,
) -> (Start, Vec<G>, f64) {
    let edges = part.edges();
    let given = || part.poses().to_vec();
    let tree = || spanning_tree(part.poses(), edges);
    let relaxed = || G::chordal_poses(&Relaxation(pattern), edges, &part.poses()[0]);
    let candidates = match initialisation {
        Initialisation::Given => vec![(Start::Given, Some(given()))],
        Initialisation::SpanningTree => vec![(Start::SpanningTree, Some(tree()))],
        Initialisation::Chordal => vec![(Start::Chordal, relaxed())],
        Initialisation::Best => {
            vec![
                (Start::Chordal, relaxed()),
                (Start::Given, Some(given())),
                (Start::SpanningTree, Some(tree())),
            ]
        }
    };
    let mut best: Option<(Start, Vec<G>, f64)> = None;
    for (start, poses) in candidates {
        let Some(poses) = poses else { continue };
        let cost = cost(edges, &poses);
        if cost.is_finite() && best.as_ref().is_none_or(|&(_, _, lowest)| cost < lowest) {
            best = Some((start, poses, cost));
        }
    }
    // The tree always exists; it stands in where the relaxation is singular or a cost overflows.
    best.unwrap_or_else(|| {
        let poses = tree();
        let cost = cost(edges, &poses);
        (Start::SpanningTree, poses, cost)
    })
}

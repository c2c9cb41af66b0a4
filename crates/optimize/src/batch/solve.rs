//! From a checked graph to its solution.

use super::component::solve_component;
use super::graduated::with_kernels;
use super::graduated_component::graduated_component;
use super::solution::{ComponentReport, Solution};
use crate::descent::phases::timed;
use crate::model::cost::chi_square;
use crate::model::gauge::{count_held, put_held_first};
use crate::model::kernel::charge;
use crate::model::part::extract;
use crate::model::prior::{PriorsOfNodes, leave_free};
use crate::model::problem::Problem;
use crate::model::residual::squared;
use crate::normal_equations::System;
use crate::options::Options;
use crate::pose_group::PoseGroup;
use posecut_cholesky::Memory;
use posecut_graph::connectivity::connected_components;

/// Minimises the cost of a graph over its poses.
///
/// Every connected component is solved on its own. Held nodes keep their given poses at every start; in a component without
/// held nodes and priors, the first node does. Priors move a start rigidly first, except the given poses. If edges leave a
/// component undetermined, its equations are damped, and the report says so. The result depends only on the input: sums have a fixed order.
pub fn optimize<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    options: &Options,
) -> Solution<G> {
    G::solve(problem, options)
}

/// [`optimize`] with the memory of earlier components. It also passes the system of each component, in their order, to `keep`:
/// `None` where there is none.
pub(crate) fn optimize_and_keep<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    options: &Options,
    memory: Vec<Memory>,
    mut keep: impl FnMut(Option<System<DOF>>),
) -> Solution<G> {
    let graduated;
    let problem = if let Some(graduation) = options.graduated {
        graduated = with_kernels(problem, Some(graduation.kernel()));
        &graduated
    } else {
        problem
    };
    let edges = problem.edges();
    let mut components =
        connected_components(problem.poses().len(), edges.iter().map(|edge| (edge.from, edge.to)));
    let mut poses = problem.poses().to_vec();
    let mut starts = poses.clone();
    let mut reports = Vec::with_capacity(components.len());
    let priors = PriorsOfNodes::new(problem.priors());
    let mut local = vec![0; poses.len()];
    let mut memory = memory.into_iter();
    let whole = components.len() == 1;
    for component in &mut components {
        let held = put_held_first(component, problem.held(), priors.anchor(component));
        for (index, &node) in component.nodes.iter().enumerate() {
            local[node] = index;
        }
        let extracted;
        let part = if whole && component.nodes.is_sorted() {
            problem
        } else {
            extracted = extract(problem, component, &priors, &local);
            &extracted
        };
        let memory = memory.next().unwrap_or_default();
        let mut seconds = 0.0;
        let (start, result, mut report, system) = timed(&mut seconds, || match options.graduated {
            Some(graduation) => graduated_component(part, held, graduation, options, memory),
            None => solve_component(part, held, options, memory),
        });
        keep(system);
        report.phases.total = seconds;
        report.gauge = component.nodes[0];
        report.held = count_held(component, problem.held());
        report.priors = part.priors().len();
        report.free = report.held == 0 && leave_free(part.priors());
        report.undetermined = report.undetermined.map(|(node, axis)| (component.nodes[node], axis));
        for ((&node, start), pose) in component.nodes.iter().zip(start).zip(result) {
            starts[node] = start;
            poses[node] = pose;
        }
        reports.push(report);
    }
    gather(problem, poses, &starts, reports)
}

/// The solution of the whole graph.
fn gather<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    poses: Vec<G>,
    starts: &[G],
    reports: Vec<ComponentReport>,
) -> Solution<G> {
    let edges = problem.edges();
    let priors = problem.priors();
    let robust =
        edges.iter().any(|edge| edge.kernel.is_some()) || priors.iter().any(|prior| prior.kernel.is_some());
    // A fold, since the `sum` of an empty iterator is -0.
    let total = |of: fn(&ComponentReport) -> f64| reports.iter().map(of).fold(0.0, |sum, part| sum + part);
    Solution {
        chi_square_given: if robust {
            chi_square(problem, problem.poses())
        } else {
            total(|report| report.cost_given)
        },
        chi_square_initial: if robust {
            chi_square(problem, starts)
        } else {
            total(|report| report.cost_start)
        },
        chi_square: if robust { chi_square(problem, &poses) } else { total(|report| report.cost) },
        cost: total(|report| report.cost),
        iterations: reports.iter().map(|report| report.iterations).sum(),
        converged: reports.iter().all(|report| report.termination.converged()),
        weights: if robust {
            edges.iter().map(|edge| charge(edge.kernel, squared(edge, &poses)).1).collect()
        } else {
            vec![1.0; edges.len()]
        },
        prior_weights: priors.iter().map(|prior| prior.charge(&poses[prior.node]).1).collect(),
        components: reports,
        poses,
    }
}

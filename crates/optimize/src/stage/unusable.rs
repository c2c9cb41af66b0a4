//! A cost that is not finite, and the edge that causes it.

use posecut_geometry::LieGroup;

use crate::model::magnitude::{distance, size};
use crate::model::problem::Edge;
use crate::{Problem, Solution};

/// Refuses a solution whose cost is not finite, since it could not be written as a number. `name` names the edge with a given
/// index in the list.
pub fn refuse_unless_finite<G: LieGroup<DOF>, const DOF: usize>(
    cost: f64,
    edges: &[Edge<G, DOF>],
    name: impl Fn(usize) -> String,
) -> anyhow::Result<()> {
    if cost.is_finite() {
        return Ok(());
    }
    // The largest edge is the one that overflows; its logarithm does not.
    let largeness =
        |edge: &Edge<G, DOF>| size(edge, 1.0).ln() + 2.0 * (1.0 + distance(&edge.measurement)).ln();
    let worst = (0..edges.len()).max_by(|&a, &b| largeness(&edges[a]).total_cmp(&largeness(&edges[b])));
    let edge = worst.map(name).unwrap_or_default();
    anyhow::bail!(
        "the cost of the solution is not finite: {edge} has the largest information and measurement; give it finite, moderate values or reject it"
    )
}

/// Refuses a solution in which the cost of a prior is not finite. `name` names the prior with a given index.
pub(super) fn refuse_infinite_priors<G: LieGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    solution: &Solution<G>,
    name: impl Fn(usize) -> String,
) -> anyhow::Result<()> {
    if solution.cost.is_finite() {
        return Ok(());
    }
    let is_infinite = |prior: &crate::Prior<G, DOF>| {
        !prior.squared(&solution.poses[prior.node]).is_finite()
            || !prior.squared(&problem.poses()[prior.node]).is_finite()
    };
    match problem.priors().iter().position(is_infinite) {
        None => Ok(()),
        Some(prior) => anyhow::bail!(
            "the cost of the solution is not finite: {} is too far away for its information; give it finite, moderate values or reject it",
            name(prior)
        ),
    }
}

//! How far an estimate and its reference are from the ground truth.
//!
//! A reference is not the truth: the optimum of the correct edges inherits the errors of the odometry. An estimate that differs
//! from it may be closer to the truth.

use posecut_graph::PoseGraph;
use serde::Serialize;

use crate::alignment::Freedom;
use crate::result::{Scope, groups, pairs};
use crate::summary::Summary;
use crate::trajectory::{Match, align, errors};

/// Distances from the ground truth, over the nodes of the estimate that have one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GroundTruth {
    /// Nodes compared.
    pub poses: usize,
    /// RMSE of the estimate, metres, aligned by the same motions and over the same groups of poses as with the reference.
    pub rmse: f64,
    /// RMSE of the reference, metres.
    pub reference_rmse: f64,
    /// RMSE of the estimate, metres, where the poses that its own edges in use connect share an alignment. It measures the map that
    /// the estimate claims: a false join counts even if no correct edge joins the same parts, and a join that is missing does not.
    pub joined_rmse: f64,
}

impl GroundTruth {
    /// Compares the poses of the nodes that estimate and reference share with the truth of the estimate's nodes; `None` if there
    /// is no such node.
    pub(crate) fn of(
        estimate: &PoseGraph,
        reference: &PoseGraph,
        freedom: Freedom,
        scope: Scope,
    ) -> Option<Self> {
        let compared = |side: usize, components: &PoseGraph| {
            pairs(estimate, components, |node| {
                let known = reference.nodes.get(reference.node_index(node.id)?)?;
                let both = [node.pose.as_deref()?, known.pose.as_deref()?];
                Some([both[side], node.truth.as_ref()?.pose.as_deref()?])
            })
        };
        let own = compared(0, reference);
        Some(Self {
            poses: own.len(),
            rmse: rmse(&own, freedom, scope)?,
            reference_rmse: rmse(&compared(1, reference), freedom, scope)?,
            joined_rmse: rmse(&compared(0, estimate), freedom, Scope::PerComponent)?,
        })
    }
}

fn rmse(matches: &[Match], freedom: Freedom, scope: Scope) -> Option<f64> {
    let distances: Vec<f64> = groups(matches, scope)
        .values()
        .flat_map(|members| errors(members, &align(members, freedom)).0)
        .collect();
    Some(Summary::of(&distances)?.rmse)
}

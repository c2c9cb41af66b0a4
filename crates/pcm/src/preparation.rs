//! The chains and candidates of a graph according to the options, for the stage and its replay.

use posecut_graph::PoseGraph;

use crate::calibration::{NoScales, ScaleEstimate, estimate_scales};
use crate::odometry::chain::{Chains, Covariances};
use crate::pairs::candidate::{Group, Grouped, group_with};
use crate::{Options, PcmError, Spatial, Test};

/// The chains of a graph and its candidates; without covariances if no test uses them.
pub(crate) fn candidates<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &PoseGraph,
) -> Result<(Chains<G, DOF>, Grouped<G, DOF>), PcmError> {
    let covariances =
        if options.test == Test::Threshold { Covariances::Ignored } else { Covariances::Needed };
    let chains = Chains::with(graph, covariances)?;
    let grouped = group_with(graph, &chains, covariances)?;
    Ok((chains, grouped))
}

/// Estimates scales if they are requested, and applies the scales of the options to chains and candidates.
pub(crate) fn scale<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    chains: &mut Chains<G, DOF>,
    groups: &mut [Group<G, DOF>],
) -> Option<Result<ScaleEstimate, NoScales>> {
    let estimate = options.wants_estimate().then(|| estimate_scales(chains, groups));
    options.scales(estimate.and_then(Result::ok)).apply(chains, groups);
    estimate
}

//! Tests whether the odometry's covariance describes its errors, over one step and over many.

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use posecut_geometry::covariance::{compose, covariance_from_information, information_from_covariance};
use posecut_graph::{EdgeKind, PoseGraph, for_dimension};
use serde::Serialize;

/// Lengths of the windows, in keyframe steps.
pub const WINDOWS: [usize; 5] = [1, 10, 30, 100, 300];

/// The mean normalised estimation error squared over all windows of one length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Nees {
    /// Length of the windows, in keyframe steps.
    pub steps: usize,
    /// Number of windows whose two ends have ground truth; the windows overlap.
    pub windows: usize,
    /// Mean of `xi^T Sigma^-1 xi` divided by the degrees of freedom: 1 if the covariance describes the errors, above 1
    /// if the covariance is too small, below 1 if it is too large.
    pub per_degree_of_freedom: f64,
}

/// The mean NEES for each length of [`WINDOWS`] that fits into the graph; empty without truth or information. The graph
/// must be one session with nodes in order, each joined to the next by an odometry edge.
///
/// `xi = Log(Z^-1 T)`, where Z is the odometry's motion over the window and T the true motion. Sigma is the covariance
/// of Z: the sum of the steps' covariances, each carried to the window's end by the adjoint (first order). O(nodes *
/// longest window).
pub fn nees(graph: &PoseGraph) -> Vec<Nees> {
    for_dimension!(graph.header.dimension, |G, DOF| measure::<G, DOF>(graph))
}

/// One odometry step and its covariance.
type Step<G, const DOF: usize> = (G, SMatrix<f64, DOF, DOF>);

fn measure<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph) -> Vec<Nees> {
    let steps = steps::<G, DOF>(graph);
    let truth: Vec<Option<G>> =
        graph.nodes.iter().map(|node| G::from_components(node.truth.as_ref()?.pose.as_deref()?)).collect();
    let mut sums = [0.0; WINDOWS.len()];
    let mut counts = [0_usize; WINDOWS.len()];
    for start in 0..truth.len() {
        let Some(from) = truth[start] else { continue };
        let (mut motion, mut covariance) = (G::identity(), SMatrix::<f64, DOF, DOF>::zeros());
        for length in 1..=WINDOWS[WINDOWS.len() - 1] {
            let Some(Some((step, own))) = steps.get(start + length - 1) else { break };
            covariance = compose(&covariance, step, own);
            motion = motion.compose(step);
            let Some(place) = WINDOWS.iter().position(|&window| window == length) else { continue };
            let Some(to) = truth[start + length] else { continue };
            let Ok(information) = information_from_covariance(&covariance) else { continue };
            // xi = Log(Z^-1 T)
            let error = motion.between(&from.between(&to)).log();
            sums[place] += error.dot(&(information * error)) / DOF as f64;
            counts[place] += 1;
        }
    }
    let measured = WINDOWS.into_iter().zip(sums.into_iter().zip(counts));
    measured
        .filter(|&(_, (_, windows))| windows > 0)
        .map(|(steps, (sum, windows))| Nees { steps, windows, per_degree_of_freedom: sum / windows as f64 })
        .collect()
}

/// The odometry step from each node to the next; `None` without a usable information matrix.
fn steps<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph) -> Vec<Option<Step<G, DOF>>> {
    let mut steps = vec![None; graph.nodes.len().saturating_sub(1)];
    for edge in graph.edges_of(EdgeKind::Odometry) {
        let Some((from, to)) = graph.ends(edge) else { continue };
        let known = || {
            let motion = G::from_components(edge.measurement.as_deref()?)?;
            let information = graph.information_matrix(edge)?.ok()?;
            Some((motion, covariance_from_information(&information).ok()?))
        };
        if to == from + 1 {
            steps[from] = known();
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight drive in which every step is `error` metres too long and `sigma` is the stated standard deviation.
    fn drive(nodes: usize, error: f64, sigma: f64) -> PoseGraph {
        let information = 1.0 / (sigma * sigma);
        let mut text = format!(
            "{{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2,\"noise_models\":{{\"odometry\":{{\"information\":[{information},0,0,{information},0,{information}]}}}}}}\n"
        );
        for node in 0..nodes {
            text.push_str(&format!(
                "{{\"kind\":\"node\",\"id\":{node},\"session\":\"s\",\"pose\":[{},0,0],\"truth\":{{\"pose\":[{node},0,0]}}}}\n",
                node as f64 * (1.0 + error)
            ));
        }
        for edge in 1..nodes {
            text.push_str(&format!(
                "{{\"kind\":\"odometry\",\"id\":{},\"from\":{},\"to\":{edge},\"measurement\":[{},0,0],\"noise\":\"odometry\"}}\n",
                edge - 1,
                edge - 1,
                1.0 + error
            ));
        }
        PoseGraph::read("drive", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn a_constant_error_grows_with_the_window_against_its_covariance() {
        // One step: (0.3 / 0.1)^2 / 3 degrees of freedom. Over n steps the error grows with n and the standard
        // deviation of x with sqrt(n), so the NEES grows with n: x is not correlated with the rest.
        let found = nees(&drive(120, 0.3, 0.1));
        let expected = [(1, 119, 3.0), (10, 110, 30.0), (30, 90, 90.0), (100, 20, 300.0)];
        assert_eq!(found.len(), expected.len(), "no window of 300 steps");
        for (found, (steps, windows, value)) in found.iter().zip(expected) {
            assert_eq!((found.steps, found.windows), (steps, windows));
            assert!((found.per_degree_of_freedom - value).abs() < 1e-9 * value, "{found:?}");
        }
    }

    #[test]
    fn windows_without_truth_at_an_end_do_not_count() {
        let mut graph = drive(12, 0.1, 0.1);
        graph.nodes[0].truth = None;
        let found: Vec<(usize, usize)> =
            nees(&graph).iter().map(|found| (found.steps, found.windows)).collect();
        assert_eq!(found, [(1, 10), (10, 1)]);
        for node in &mut graph.nodes {
            node.truth = None;
        }
        assert!(nees(&graph).is_empty());
    }
}

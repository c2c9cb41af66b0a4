//! Normalised estimation errors squared, `xi^T Sigma^-1 xi`, by the true poses.

use std::fmt;

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_geometry::covariance::information_from_covariance;
use posecut_graph::PoseGraph;
use posecut_pcm::chain::{Chains, Covariances};
use posecut_pcm::chi_square_quantile;
use serde::Serialize;

use crate::survey::Survey;
use crate::words::figure;

/// Lengths of the windows, in odometry steps.
const WINDOWS: [usize; 3] = [1, 10, 100];

/// The mean over all windows of one length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Nees {
    /// Length of the windows in odometry steps; `None` for landmark edges.
    pub(super) steps: Option<usize>,
    /// Number of windows that do not overlap, or of edges.
    pub(super) windows: usize,
    /// The mean divided by the degrees of freedom: 1 if the covariance describes the errors, above 1 if it is too small.
    pub(super) value: f64,
    /// The interval in which this mean is with probability 95 % if the covariance is right.
    pub(super) expected: [f64; 2],
}

impl Nees {
    /// The mean of squares. `windows` is the number of independent ones.
    fn of<const DOF: usize>(steps: Option<usize>, squares: &[f64], windows: usize) -> Option<Self> {
        let value = squares.iter().sum::<f64>() / (squares.len() * DOF) as f64;
        let degrees = windows * DOF;
        let bound = |probability| Some(chi_square_quantile(probability, degrees).ok()? / degrees as f64);
        let expected = [bound(0.025)?, bound(0.975)?];
        (windows > 0 && value.is_finite()).then_some(Self { steps, windows, value, expected })
    }

    /// The window, in words.
    pub(super) fn span(&self) -> String {
        match self.steps {
            Some(1) => "1 step".to_owned(),
            Some(steps) => format!("{steps} steps"),
            None => format!("{} edges", self.windows),
        }
    }
}

impl fmt::Display for Nees {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.expected.map(figure);
        write!(formatter, "{} over {} ({low} to {high})", figure(self.value), self.span())
    }
}

/// The odometry over all windows along the chains that have truth at both ends. Windows overlap, which makes the mean more
/// certain than their number; the interval is that of windows that do not.
///
/// With poses `P` and covariances `S` accumulated along a chain, `xi = Log((P_i^-1 P_j)^-1 (T_i^-1 T_j))`, and its covariance is
/// that of the stretch, `S_j - S_i`, carried to the frame of node j.
pub(super) fn odometry<G: LieGroup<DOF>, const DOF: usize>(survey: &Survey<'_>) -> Vec<Nees> {
    let graph = survey.graph;
    let Ok(chains) = Chains::<G, DOF>::with(graph, Covariances::Repaired) else { return Vec::new() };
    let mut truth: Vec<Vec<Option<G>>> =
        chains.chains.iter().map(|chain| vec![None; chain.poses.len()]).collect();
    for (node, &(chain, place)) in chains.places.iter().enumerate() {
        truth[chain][place] = true_pose(graph, node);
    }
    let window = |steps: usize| {
        let mut squares = Vec::new();
        for (chain, truth) in chains.chains.iter().zip(&truth) {
            for start in 0..chain.poses.len().saturating_sub(steps) {
                let end = start + steps;
                let (Some(from), Some(to)) = (truth[start], truth[end]) else { continue };
                let motion = chain.poses[start].between(&chain.poses[end]);
                let back = chain.poses[end].inverse().adjoint();
                let covariance = back * chain.covariance_between(start, end) * back.transpose();
                let error = motion.between(&from.between(&to)).log();
                squares.extend(squared(&error, &covariance));
            }
        }
        Nees::of::<DOF>(Some(steps), &squares, squares.len() / steps)
    };
    WINDOWS.into_iter().filter_map(window).collect()
}

/// The landmark edges that are labelled correct.
pub(super) fn landmark<G: LieGroup<DOF>, const DOF: usize>(survey: &Survey<'_>) -> Vec<Nees> {
    let graph = survey.graph;
    let mut squares = Vec::new();
    for edge in survey.landmark.iter().filter(|edge| edge.edge.truth_correct() == Some(true)) {
        let measured = graph.measurement::<G, DOF>(edge.edge).ok().flatten();
        let truth = true_pose::<G, DOF>(graph, edge.ends.0).zip(true_pose::<G, DOF>(graph, edge.ends.1));
        if let (Some((motion, information)), Some((from, to))) = (measured, truth) {
            let error = motion.between(&from.between(&to)).log();
            squares.push(error.dot(&(information * error)));
        }
    }
    Nees::of::<DOF>(None, &squares, squares.len()).into_iter().collect()
}

fn true_pose<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph, node: usize) -> Option<G> {
    G::from_components(graph.nodes[node].truth.as_ref()?.pose.as_deref()?)
}

fn squared<const DOF: usize>(error: &SVector<f64, DOF>, covariance: &SMatrix<f64, DOF, DOF>) -> Option<f64> {
    // Symmetric but for rounding, which the inverse refuses.
    let symmetric = (covariance + covariance.transpose()) * 0.5;
    let information = information_from_covariance(&symmetric).ok()?;
    Some(error.dot(&(information * error)))
}

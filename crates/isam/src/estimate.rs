//! The estimate of the poses.

use nalgebra::SVector;
use posecut_geometry::LieGroup;

/// Poses as points of linearisation and linear updates: pose `k` is `points[k] * Exp(deltas[k])`.
#[derive(Debug)]
pub(crate) struct Estimate<G, const DOF: usize> {
    pub(crate) points: Vec<G>,
    pub(crate) deltas: Vec<SVector<f64, DOF>>,
}

impl<G, const DOF: usize> Default for Estimate<G, DOF> {
    fn default() -> Self {
        Self { points: Vec::new(), deltas: Vec::new() }
    }
}

impl<G: LieGroup<DOF>, const DOF: usize> Estimate<G, DOF> {
    pub(crate) fn add(&mut self, pose: G) {
        self.points.push(pose);
        self.deltas.push(SVector::zeros());
    }

    pub(crate) fn pose(&self, node: usize) -> G {
        self.points[node].compose(&G::exp(&self.deltas[node]))
    }

    pub(crate) fn poses(&self) -> Vec<G> {
        (0..self.points.len()).map(|node| self.pose(node)).collect()
    }

    /// Moves the point of linearisation here. Models of the node's edges have to be made again.
    pub(crate) fn reset(&mut self, node: usize, pose: G) {
        self.points[node] = pose;
        self.deltas[node] = SVector::zeros();
    }
}

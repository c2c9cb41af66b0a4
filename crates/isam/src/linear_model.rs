//! The linear model of an edge, and its error.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_optimize::model::{Expansion, Linearised, charge};
use posecut_optimize::{Edge, residual};

/// An edge's residual as a linear function of the linear updates of its ends: `e = constant + from d_from + to d_to`.
pub(crate) struct LinearModel<const DOF: usize> {
    /// Blocks of the normal equations, and half the gradients.
    pub(crate) blocks: Linearised<DOF>,
    constant: SVector<f64, DOF>,
    from: SMatrix<f64, DOF, DOF>,
    to: SMatrix<f64, DOF, DOF>,
    /// The weight of the robust kernel.
    weight: f64,
}

impl<const DOF: usize> LinearModel<DOF> {
    /// A placeholder until an edge is linearised.
    pub(crate) fn none() -> Self {
        Self {
            blocks: Linearised {
                from_from: SMatrix::zeros(),
                from_to: SMatrix::zeros(),
                to_to: SMatrix::zeros(),
                from_gradient: SVector::zeros(),
                to_gradient: SVector::zeros(),
                cost: 0.0,
            },
            constant: SVector::zeros(),
            from: SMatrix::zeros(),
            to: SMatrix::zeros(),
            weight: 1.0,
        }
    }

    /// Linearises an edge at these poses.
    pub(crate) fn new<G: LieGroup<DOF>>(edge: &Edge<G, DOF>, poses: &[G]) -> Self {
        let expansion = Expansion::new(edge, &poses[edge.from], &poses[edge.to]);
        let (blocks, weight) = expansion.model(edge);
        Self { blocks, constant: expansion.error, from: expansion.from(), to: expansion.to, weight }
    }

    /// The squared difference, in standard deviations, between the weighted residual at two poses and the model's residual at
    /// their linear updates; and the edge's cost at these poses.
    ///
    /// After the linear system is solved, the remaining gradient is the sum over all edges of `J^T Omega d`, with these
    /// differences `d`, and of `(dJ)^T Omega e`, from derivatives that have changed. The squares measure the first term.
    pub(crate) fn error<G: LieGroup<DOF>>(
        &self,
        edge: &Edge<G, DOF>,
        [from_pose, to_pose]: [&G; 2],
        [from_delta, to_delta]: [&SVector<f64, DOF>; 2],
    ) -> (f64, f64) {
        let actual = residual(&edge.measurement, from_pose, to_pose);
        let predicted = self.constant + self.from * from_delta + self.to * to_delta;
        let (cost, weight) = charge(edge.kernel, actual.dot(&(edge.information * actual)));
        let difference = actual * weight - predicted * self.weight;
        (difference.dot(&(edge.information * difference)), cost)
    }
}

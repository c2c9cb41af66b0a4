//! Residuals of edges and their Jacobians.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Simd;
use nalgebra::{SMatrix, SVector};
use posecut_geometry::{LieGroup, translations};

use super::curvature::curve;
use super::kernel::charge;
use super::lanes::LaneGroup;
use super::problem::Edge;
use super::quadratic::{Gradient, Linearised, triangular_congruence};
use super::term::{Link, Term};

/// `e = Log(Z^-1 X_from^-1 X_to)`.
#[inline(always)]
pub fn residual<G: LieGroup<DOF>, const DOF: usize>(measurement: &G, from: &G, to: &G) -> SVector<f64, DOF> {
    measurement.between(&from.between(to)).log()
}

/// `e^T Omega e` of one edge.
#[inline(always)]
pub(crate) fn squared<G: LieGroup<DOF>, const DOF: usize>(edge: &Edge<G, DOF>, poses: &[G]) -> f64 {
    let error = residual(&edge.measurement, &poses[edge.from], &poses[edge.to]);
    error.dot(&(edge.information * error))
}

impl<G: LaneGroup<DOF>, const DOF: usize> Term<G, DOF> for Edge<G, DOF> {
    #[inline(always)]
    fn cost(&self, poses: &[G]) -> f64 {
        charge(self.kernel, squared(self, poses)).0
    }

    /// In a direction that the information does not measure, large residuals cancel in `e^T Omega e` up to rounding errors.
    fn rounding(&self, poses: &[G]) -> f64 {
        let error = residual(&self.measurement, &poses[self.from], &poses[self.to]).abs();
        4.0 * f64::EPSILON * error.dot(&(self.information.abs() * error))
    }

    #[inline(always)]
    fn linearise(&self, poses: &[G]) -> Linearised<DOF> {
        linearise(self, poses)
    }

    fn link(&self, length: f64) -> Option<Link> {
        let share = |axis: usize| {
            let unit = if axis < translations(DOF) { length * length } else { 1.0 };
            1.0 / (unit * self.information[(axis, axis)])
        };
        Some(Link { from: self.from, to: self.to, variance: (0..DOF).map(share).sum() })
    }

    fn curve(&self, poses: &[G]) -> Linearised<DOF> {
        curve(self, poses)
    }

    fn bend(&self, poses: &[G], ahead: &[G], behind: &[G], share: f64) -> Option<Gradient<DOF>> {
        let relative = poses[self.from].between(&poses[self.to]);
        let (error, jacobian) = self.measurement.between(&relative).log_with_jacobian();
        let (cost, weight) = charge(self.kernel, error.dot(&(self.information * error)));
        let at = |poses: &[G]| residual(&self.measurement, &poses[self.from], &poses[self.to]);
        let second = (at(ahead) + at(behind) - error * 2.0) / (share * share);
        Some(Gradient::new(&relative, jacobian.tr_mul(&(self.information * second)) * weight, cost))
    }

    #[inline(always)]
    fn gradient(&self, poses: &[G]) -> Gradient<DOF> {
        let relative = poses[self.from].between(&poses[self.to]);
        let (error, jacobian) = self.measurement.between(&relative).log_with_jacobian();
        let weighted = self.information * error;
        let (cost, weight) = charge(self.kernel, error.dot(&weighted));
        let to = jacobian.tr_mul(&weighted) * weight;
        Gradient::new(&relative, to, cost)
    }

    #[inline(always)]
    fn costs<S: Simd>(simd: S, terms: &[Self], poses: &[G], costs: &mut [f64]) -> bool {
        G::costs(simd, terms, poses, costs)
    }

    #[inline(always)]
    fn gradients<S: Simd>(simd: S, terms: &[Self], poses: &[G], gradients: &mut [Gradient<DOF>]) -> bool {
        G::gradients(simd, terms, poses, gradients)
    }

    #[inline(always)]
    fn models<S: Simd>(simd: S, terms: &[Self], poses: &[G], models: &mut [Linearised<DOF>]) -> bool {
        G::models(simd, terms, poses, models)
    }
}

/// The residual of an edge and its derivatives.
///
/// With `X_ij = X_i^-1 X_j` and `E = Z^-1 X_ij`: `J_j = J_r^-1(Log E)`, and since `Exp(-d) X_ij = X_ij Exp(-Ad(X_ij^-1) d)`,
/// `J_i = -J_j Ad(X_ij^-1)`.
pub struct Expansion<G, const DOF: usize> {
    relative: G,
    /// `Log E`.
    pub error: SVector<f64, DOF>,
    /// `J_j`.
    pub to: SMatrix<f64, DOF, DOF>,
}

impl<G: LieGroup<DOF>, const DOF: usize> Expansion<G, DOF> {
    /// Expands the residual at these poses of the edge's ends.
    #[inline(always)]
    pub fn new(edge: &Edge<G, DOF>, from: &G, to: &G) -> Self {
        let relative = from.between(to);
        let (error, to) = edge.measurement.between(&relative).log_with_jacobian();
        Self { relative, error, to }
    }

    /// `J_i`.
    #[inline(always)]
    pub fn from(&self) -> SMatrix<f64, DOF, DOF> {
        -self.to * self.relative.inverse().adjoint()
    }

    /// The quadratic model and the kernel's weight. All blocks follow from `A = J_j^T w Omega J_j` by the adjoint.
    #[inline(always)]
    pub fn model(&self, edge: &Edge<G, DOF>) -> (Linearised<DOF>, f64) {
        let weighted = edge.information * self.error;
        let (cost, weight) = charge(edge.kernel, self.error.dot(&weighted));
        let to_to = triangular_congruence(&self.to, &edge.information).1 * weight;
        let to_gradient = self.to.tr_mul(&weighted) * weight;
        (Linearised::new(&self.relative, to_to, to_gradient, cost), weight)
    }
}

/// Linearises an edge.
#[inline(always)]
pub(crate) fn linearise<G: LieGroup<DOF>, const DOF: usize>(
    edge: &Edge<G, DOF>,
    poses: &[G],
) -> Linearised<DOF> {
    Expansion::new(edge, &poses[edge.from], &poses[edge.to]).model(edge).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::problem::EdgeKind;
    use posecut_geometry::{SE2, SE3};

    /// Compares gradient and blocks of the model with central differences of the residual.
    fn check<G: LieGroup<DOF>, const DOF: usize>(from: G, to: G, measurement: G) {
        let spread =
            SMatrix::<f64, DOF, DOF>::from_fn(|row, column| ((row * 7 + column * 3) % 5) as f64 * 0.1);
        let information = SMatrix::identity() + spread * spread.transpose();
        let edge = Edge::new(0, 1, measurement, information, EdgeKind::Landmark);
        let model = linearise(&edge, &[from, to]);
        let step = 1e-6;
        let derivative = |node: usize| {
            let mut jacobian = SMatrix::<f64, DOF, DOF>::zeros();
            for axis in 0..DOF {
                let at = |offset: f64| {
                    let mut tangent = SVector::<f64, DOF>::zeros();
                    tangent[axis] = offset;
                    let mut poses = [from, to];
                    poses[node] = poses[node].compose(&G::exp(&tangent));
                    residual(&edge.measurement, &poses[0], &poses[1])
                };
                jacobian.set_column(axis, &((at(step) - at(-step)) / (2.0 * step)));
            }
            jacobian
        };
        let (by_from, by_to) = (derivative(0), derivative(1));
        let error = residual(&edge.measurement, &from, &to);
        let close = |found: SMatrix<f64, DOF, DOF>, expected: SMatrix<f64, DOF, DOF>| {
            assert!((found - expected).amax() < 1e-7 * (1.0 + expected.amax()), "{found} {expected}");
        };
        close(model.from_from, by_from.transpose() * information * by_from);
        close(model.from_to, by_from.transpose() * information * by_to);
        close(model.to_to, by_to.transpose() * information * by_to);
        let gradient = by_from.transpose() * information * error;
        assert!((model.from_gradient - gradient).amax() < 1e-7 * (1.0 + gradient.amax()));
        let gradient = by_to.transpose() * information * error;
        assert!((model.to_gradient - gradient).amax() < 1e-7 * (1.0 + gradient.amax()));
        assert!((model.cost - error.dot(&(information * error))).abs() < 1e-12 * model.cost);
    }

    #[test]
    fn models_in_the_plane_match_finite_differences() {
        check(SE2::new(1.0, 2.0, -0.7), SE2::new(3.0, -1.0, 2.9), SE2::new(1.5, -2.0, -2.4));
        check(SE2::new(1.0, 2.0, 3.1), SE2::new(0.0, 0.5, -3.1), SE2::new(0.9, 1.4, -0.1));
    }

    #[test]
    fn models_in_space_match_finite_differences() {
        let from = SE3::from_euler(1.0, 2.0, -1.0, 0.3, -0.8, 2.9);
        let to = SE3::from_euler(-1.0, 0.5, 2.0, -0.6, 1.1, -2.0);
        check(from, to, SE3::from_euler(1.0, 1.0, 0.5, 0.2, 0.1, -0.4));
        check(from, to, from.between(&to));
    }
}

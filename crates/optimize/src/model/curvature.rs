//! The exact second derivative of an edge's cost.
//!
//! Gauss-Newton takes `J^T Omega J` for half the second derivative of `e^T Omega e` and leaves out the curvature of the residual
//! itself. Where residuals are large, as under rotation noise of tenths of a radian, that curvature decides: steps that leave
//! it out converge slowly or not at all.
//!
//! With `e(w) = Log(E Exp(w))`, `J = J_r^-1(e)` and `lambda = Omega e`, the second derivative of `e(w)^T lambda`, for fixed
//! `lambda`, in directions `u` and `v` is `(D J_r^-1(e)[J u] v)^T lambda - (J^T lambda)^T [u, v] / 2`, since
//! `Exp(w + v) = Exp(w) Exp(J_r(w) v)` to first order in `v`, with `J_r(w) = I - ad(w) / 2 + O(w^2)`. The second summand is
//! antisymmetric, so the symmetric part of the first is all of it. Both ends of an edge move: `X_i Exp(c)` and `X_j Exp(d)` change `E`
//! to `E Exp(a) Exp(d)` with `a = -Ad(X_ij^-1) c`, and `Log(Exp(a) Exp(d)) = a + d + [a, d] / 2 + ...` adds `g^T [a, d] / 2` to the
//! block between them, with `g = J^T lambda`.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::{LieGroup, translations};

use super::kernel::charge;
use super::problem::Edge;
use super::quadratic::Linearised;

/// Step of the central differences of `J_r^-1`, radians; the derivative is then exact to about 1e-9.
const STEP: f64 = 1e-4;

/// The quadratic model of an edge's cost with the exact second derivative at these poses. Kernels count by their weights.
pub(crate) fn curve<G: LieGroup<DOF>, const DOF: usize>(edge: &Edge<G, DOF>, poses: &[G]) -> Linearised<DOF> {
    let relative = poses[edge.from].between(&poses[edge.to]);
    let error = edge.measurement.between(&relative).log();
    let jacobian = G::right_jacobian_inverse(&error);
    let pull = edge.information * error;
    let (cost, weight) = charge(edge.kernel, error.dot(&pull));
    let gradient = jacobian.tr_mul(&pull) * weight;
    // `a^T bracket d = g^T [a, d]`.
    let mut bracket = SMatrix::<f64, DOF, DOF>::zeros();
    for axis in 0..DOF {
        let mut unit = SVector::<f64, DOF>::zeros();
        unit[axis] = 1.0;
        bracket.set_row(axis, &gradient.tr_mul(&G::bracket(&unit)));
    }
    let curvature = jacobian.tr_mul(&change_of_pull::<G, DOF>(&error, &pull)) * weight;
    let curvature = (curvature + curvature.transpose()) * 0.5;
    let second = jacobian.tr_mul(&(edge.information * jacobian)) * weight + curvature;
    let adjoint = relative.inverse().adjoint();
    let from_to = -adjoint.tr_mul(&(second + bracket * 0.5));
    Linearised {
        from_from: adjoint.tr_mul(&(second * adjoint)),
        from_to,
        to_to: second,
        from_gradient: -adjoint.tr_mul(&gradient),
        to_gradient: gradient,
        cost,
    }
}

/// The derivative of `J_r^-1(e)^T lambda` by `e` (row: axis of `e`), for fixed `lambda`.
fn change_of_pull<G: LieGroup<DOF>, const DOF: usize>(
    error: &SVector<f64, DOF>,
    pull: &SVector<f64, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    let mut change = SMatrix::<f64, DOF, DOF>::zeros();
    let length = error.rows(0, translations(DOF)).amax();
    for axis in 0..DOF {
        let step = if axis < translations(DOF) { STEP * length.max(1.0) } else { STEP };
        let at = |offset: f64| {
            let mut moved = *error;
            moved[axis] += offset;
            G::right_jacobian_inverse(&moved).tr_mul(pull)
        };
        change.set_row(axis, &((at(step) - at(-step)) / (2.0 * step)).transpose());
    }
    change
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::problem::EdgeKind;
    use posecut_geometry::{SE2, SE3};

    /// Compares the model with second differences of the cost along random pairs of steps.
    fn check<G: LieGroup<DOF>, const DOF: usize>(from: G, to: G, measurement: G) {
        let spread =
            SMatrix::<f64, DOF, DOF>::from_fn(|row, column| ((row * 7 + column * 3) % 5) as f64 * 0.1);
        let information = SMatrix::identity() + spread * spread.transpose();
        let edge = Edge::new(0, 1, measurement, information, EdgeKind::Landmark);
        let model = curve(&edge, &[from, to]);
        for seed in 0..10 {
            let direction = |shift: usize| {
                SVector::<f64, DOF>::from_fn(|axis, _| ((seed * 13 + shift + axis * 5) as f64 * 0.7).sin())
            };
            let (c, d) = (direction(0), direction(3));
            let at = |share: f64| {
                let poses = [from.compose(&G::exp(&(c * share))), to.compose(&G::exp(&(d * share)))];
                let error = crate::model::residual::residual(&edge.measurement, &poses[0], &poses[1]);
                error.dot(&(information * error))
            };
            let step = 1e-3;
            let slope = (at(step) - at(-step)) / (2.0 * step);
            let second = (at(step) - 2.0 * at(0.0) + at(-step)) / (step * step);
            let promised = 2.0 * (c.dot(&model.from_gradient) + d.dot(&model.to_gradient));
            let curved =
                c.dot(&(model.from_from * c)) + d.dot(&(model.to_to * d)) + 2.0 * c.dot(&(model.from_to * d));
            let scale = 1.0 + second.abs();
            assert!((slope - promised).abs() < 1e-4 * scale, "{slope} {promised}");
            assert!((second - 2.0 * curved).abs() < 1e-4 * scale, "{second} {}", 2.0 * curved);
        }
    }

    #[test]
    fn the_second_derivative_in_the_plane_matches_differences() {
        check(SE2::new(1.0, 2.0, -0.7), SE2::new(3.0, -1.0, 2.9), SE2::new(1.5, -2.0, -2.4));
        check(SE2::new(1.0, 2.0, 3.1), SE2::new(0.0, 0.5, -3.1), SE2::new(0.9, 1.4, -0.1));
    }

    #[test]
    fn the_second_derivative_in_space_matches_differences() {
        let from = SE3::from_euler(1.0, 2.0, -1.0, 0.3, -0.8, 2.9);
        let to = SE3::from_euler(-1.0, 0.5, 2.0, -0.6, 1.1, -2.0);
        check(from, to, SE3::from_euler(1.0, 1.0, 0.5, 0.2, 0.1, -0.4));
        check(from, to, from.between(&to));
    }
}

//! Residuals of edges and their Jacobians.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::{Simd, WithSimd};
use nalgebra::{Matrix3, SMatrix, SVector};
use posecut_geometry::lanes::WIDTH;
use posecut_geometry::{LieGroup, translations};

use super::curvature::curve;
use super::kernel::charge;
use super::lanes::LaneGroup;
use super::prior;
use super::problem::{Edge, Problem};
use posecut_cholesky::instructions::for_small_blocks;

/// `e = Log(Z^-1 X_from^-1 X_to)`.
#[inline(always)]
pub fn residual<G: LieGroup<DOF>, const DOF: usize>(measurement: &G, from: &G, to: &G) -> SVector<f64, DOF> {
    measurement.between(&from.between(to)).log()
}

/// The sum of `e^T Omega e` over edges and priors, without kernels.
pub fn chi_square<G: LieGroup<DOF>, const DOF: usize>(problem: &Problem<G, DOF>, poses: &[G]) -> f64 {
    let edges: f64 = problem.edges().iter().map(|edge| squared(edge, poses)).sum();
    problem.priors().iter().fold(edges, |sum, prior| sum + prior.squared(&poses[prior.node]))
}

/// The sum of `rho(e^T Omega e)` over edges and priors.
pub(crate) fn cost<G: LaneGroup<DOF>, const DOF: usize>(problem: &Problem<G, DOF>, poses: &[G]) -> f64 {
    let edges = total(problem.edges(), poses);
    if problem.priors().is_empty() { edges } else { edges + prior::cost(problem.priors(), poses) }
}

/// Whether edges cost more than `limit` by more than rounding errors. Stops at the first edges, from the last one on, that do: landmark
/// edges mostly come last, and a spanning tree leaves no other residuals.
pub(crate) fn exceeds<G: LaneGroup<DOF>, const DOF: usize>(
    edges: &[Edge<G, DOF>],
    poses: &[G],
    limit: f64,
) -> bool {
    // Far above the rounding error of a sum of 1e9 terms.
    let limit = limit * (1.0 + 1e-6);
    let mut sum = 0.0;
    edges.iter().rev().any(|edge| {
        sum += edge.cost(poses);
        sum > limit
    })
}

/// The sum of the costs of terms.
pub(crate) fn total<G: LieGroup<DOF>, T: Term<G, DOF>, const DOF: usize>(terms: &[T], poses: &[G]) -> f64 {
    // Uses vector instructions of the machine for everything that is inlined below.
    for_small_blocks(Total { terms, poses })
}

/// [`total`] for one set of vector instructions. Not a closure: a closure would not be inlined.
struct Total<'a, G, T, const DOF: usize> {
    terms: &'a [T],
    poses: &'a [G],
}

impl<G: LieGroup<DOF>, T: Term<G, DOF>, const DOF: usize> WithSimd for Total<'_, G, T, DOF> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let mut sum = 0.0;
        let mut costs = [0.0; WIDTH];
        for terms in self.terms.chunks(S::F64_LANES) {
            let costs = &mut costs[..terms.len()];
            if !T::costs(simd, terms, self.poses, costs) {
                for (term, cost) in terms.iter().zip(&mut *costs) {
                    *cost = term.cost(self.poses);
                }
            }
            for &mut cost in costs {
                sum += cost;
            }
        }
        sum
    }
}

/// `e^T Omega e` of one edge.
#[inline(always)]
pub(crate) fn squared<G: LieGroup<DOF>, const DOF: usize>(edge: &Edge<G, DOF>, poses: &[G]) -> f64 {
    let error = residual(&edge.measurement, &poses[edge.from], &poses[edge.to]);
    error.dot(&(edge.information * error))
}

/// Quadratic model of one edge's cost around the current poses, in right perturbations of its two poses.
#[derive(Clone, Copy, Debug)]
pub struct Linearised<const DOF: usize> {
    /// Block of the normal equations at (from, from).
    pub from_from: SMatrix<f64, DOF, DOF>,
    /// Block at (from, to).
    pub from_to: SMatrix<f64, DOF, DOF>,
    /// Block at (to, to).
    pub to_to: SMatrix<f64, DOF, DOF>,
    /// Half the gradient at from.
    pub from_gradient: SVector<f64, DOF>,
    /// Half the gradient at to.
    pub to_gradient: SVector<f64, DOF>,
    /// `rho(e^T Omega e)`.
    pub cost: f64,
}

/// Linear model of one edge's cost.
#[derive(Clone, Copy, Debug)]
pub struct Gradient<const DOF: usize> {
    /// Half the gradient at from.
    pub from: SVector<f64, DOF>,
    /// Half the gradient at to.
    pub to: SVector<f64, DOF>,
    /// `rho(e^T Omega e)`.
    pub cost: f64,
}

impl<const DOF: usize> Gradient<DOF> {
    /// Of a term that is 0.
    pub(crate) fn zero() -> Self {
        Self { from: SVector::zeros(), to: SVector::zeros(), cost: 0.0 }
    }

    /// The model, given half the gradient in a right perturbation of `X_ij`, which equals one of `X_j`.
    #[inline(always)]
    pub fn new<G: LieGroup<DOF>>(relative: &G, to: SVector<f64, DOF>, cost: f64) -> Self {
        Self { from: -relative.inverse().adjoint().tr_mul(&to), to, cost }
    }
}

/// The ends of a summand and the sum of its variances, in squared shares of the graph's length and squared radians.
pub struct Link {
    /// First node.
    pub from: usize,
    /// Second node.
    pub to: usize,
    /// Sum of the reciprocals of the information's diagonal.
    pub variance: f64,
}

/// One summand of a cost over poses.
pub trait Term<G, const DOF: usize>: Sized {
    /// Its value.
    fn cost(&self, poses: &[G]) -> f64;
    /// Its quadratic model.
    fn linearise(&self, poses: &[G]) -> Linearised<DOF>;
    /// The cost that rounding errors alone may cause.
    fn rounding(&self, _poses: &[G]) -> f64 {
        0.0
    }
    /// Its ends, and how weakly it holds them to each other, if it holds two poses.
    fn link(&self, _length: f64) -> Option<Link> {
        None
    }
    /// Its quadratic model with the exact second derivative.
    fn curve(&self, poses: &[G]) -> Linearised<DOF> {
        self.linearise(poses)
    }
    /// Half the gradient for its second derivative in place of its residual. The derivative is along a curve through these poses, from the
    /// poses on it at the parameters `share` and `-share`. `None` if it has no residual.
    fn bend(&self, _poses: &[G], _ahead: &[G], _behind: &[G], _share: f64) -> Option<Gradient<DOF>> {
        None
    }
    /// Its linear model.
    fn gradient(&self, poses: &[G]) -> Gradient<DOF> {
        let model = self.linearise(poses);
        Gradient { from: model.from_gradient, to: model.to_gradient, cost: model.cost }
    }
    /// Writes the values of several terms, at most as many as `S` has lanes, if it can compute them together.
    #[inline(always)]
    fn costs<S: Simd>(_: S, _terms: &[Self], _poses: &[G], _costs: &mut [f64]) -> bool {
        false
    }
    /// Writes their linear models in the same way.
    #[inline(always)]
    fn gradients<S: Simd>(_: S, _terms: &[Self], _poses: &[G], _gradients: &mut [Gradient<DOF>]) -> bool {
        false
    }
    /// Writes their quadratic models in the same way.
    #[inline(always)]
    fn models<S: Simd>(_: S, _terms: &[Self], _poses: &[G], _models: &mut [Linearised<DOF>]) -> bool {
        false
    }
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

impl<const DOF: usize> Linearised<DOF> {
    /// Of a term that is 0.
    pub(crate) fn zero() -> Self {
        let (block, gradient) = (SMatrix::zeros(), SVector::zeros());
        Self {
            from_from: block,
            from_to: block,
            to_to: block,
            from_gradient: gradient,
            to_gradient: gradient,
            cost: 0.0,
        }
    }

    /// The model, given the block and half the gradient in a right perturbation of `X_ij`, which equals one of `X_j`.
    #[inline(always)]
    pub fn new<G: LieGroup<DOF>>(
        relative: &G,
        to_to: SMatrix<f64, DOF, DOF>,
        to_gradient: SVector<f64, DOF>,
        cost: f64,
    ) -> Self {
        let adjoint = relative.inverse().adjoint();
        let from_gradient = -adjoint.tr_mul(&to_gradient);
        let (product, from_from) = triangular_congruence(&adjoint, &to_to);
        let from_to = -product;
        Self { from_from, from_to, to_to, from_gradient, to_gradient, cost }
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

/// `J^T A` and `J^T A J` for symmetric `A`, where `J` is an adjoint or a Jacobian of the logarithm. In space both are
/// block-triangular, `[P, Q; 0, S]`, which saves more than half of the products.
#[inline(always)]
fn triangular_congruence<const DOF: usize>(
    jacobian: &SMatrix<f64, DOF, DOF>,
    matrix: &SMatrix<f64, DOF, DOF>,
) -> (SMatrix<f64, DOF, DOF>, SMatrix<f64, DOF, DOF>) {
    if DOF != 6 {
        let product = jacobian.tr_mul(matrix);
        return (product, product * jacobian);
    }
    let block = |of: &SMatrix<f64, DOF, DOF>, row: usize, column: usize| -> Matrix3<f64> {
        of.fixed_view::<3, 3>(3 * row, 3 * column).into_owned()
    };
    let (p, q, s) = (block(jacobian, 0, 0), block(jacobian, 0, 1), block(jacobian, 1, 1));
    let (a, b, c) = (block(matrix, 0, 0), block(matrix, 0, 1), block(matrix, 1, 1));
    let (p_a, p_b) = (p.tr_mul(&a), p.tr_mul(&b));
    let (q_a, q_b) = (q.tr_mul(&a) + s.tr_mul(&b.transpose()), q.tr_mul(&b) + s.tr_mul(&c));
    let upper_right = p_a * q + p_b * s;
    let join = |blocks: [&Matrix3<f64>; 4]| {
        let mut joined = SMatrix::<f64, DOF, DOF>::zeros();
        for (index, from) in blocks.into_iter().enumerate() {
            joined.fixed_view_mut::<3, 3>(3 * (index / 2), 3 * (index % 2)).copy_from(from);
        }
        joined
    };
    let product = join([&p_a, &p_b, &q_a, &q_b]);
    let congruence = join([&(p_a * p), &upper_right, &upper_right.transpose(), &(q_a * q + q_b * s)]);
    (product, congruence)
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

    #[test]
    fn a_cost_exceeds_limits_below_it_alone() {
        let poses: Vec<_> = (0..9).map(|node| SE2::new(f64::from(node), 0.0, 0.1)).collect();
        let edges: Vec<_> = (1..9)
            .map(|to| {
                Edge::new(to - 1, to, SE2::identity(), nalgebra::Matrix3::identity(), EdgeKind::Odometry)
            })
            .collect();
        let cost = total(&edges, &poses);
        assert!(exceeds(&edges, &poses, 0.9 * cost) && exceeds(&edges, &poses, 0.0));
        assert!(!exceeds(&edges, &poses, cost) && !exceeds(&edges, &poses, f64::NAN));
    }
}

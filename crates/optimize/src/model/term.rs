//! What the solver asks of the summands of a cost.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Simd;

use super::quadratic::{Gradient, Linearised};

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

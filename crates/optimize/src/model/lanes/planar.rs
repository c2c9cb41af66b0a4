//! Edges in the plane, one in each lane.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Simd;
use nalgebra::{Complex, UnitComplex, Vector2, Vector3};
use posecut_geometry::SE2;
use posecut_geometry::trigonometric::SERIES_LIMIT;

use super::half_angle::{HalfAngle, LARGEST};
use posecut_geometry::lanes::{Lanes, WIDTH};

use super::{Ends, LaneGroup, Models, even, three, write_gradients};
use crate::model::problem::Edge;
use crate::model::quadratic::{Gradient, Linearised};

/// `X_ij`: translation, cosine and sine.
#[derive(Clone, Copy)]
struct Relative<S: Simd> {
    x: Lanes<S>,
    y: Lanes<S>,
    cosine: Lanes<S>,
    sine: Lanes<S>,
}

/// The residuals of edges: `e = Log(Z^-1 X_ij)`.
struct Residual<S: Simd> {
    relative: Relative<S>,
    /// Translation of `Z^-1 X_ij`.
    offset: (Lanes<S>, Lanes<S>),
    functions: HalfAngle<S>,
    /// Tangent of half the angle.
    tangent: Lanes<S>,
    /// Half the angle.
    half: Lanes<S>,
    error: [Lanes<S>; 3],
}

impl<S: Simd> Residual<S> {
    /// `None` if one of them turns too far.
    #[inline(always)]
    fn of(simd: S, ends: &Ends<'_, SE2, 3>) -> Option<Self> {
        let (x, y) = (
            ends.of_to(simd, |pose| pose.translation.x) - ends.of_from(simd, |pose| pose.translation.x),
            ends.of_to(simd, |pose| pose.translation.y) - ends.of_from(simd, |pose| pose.translation.y),
        );
        let from = (ends.of_from(simd, |pose| pose.rotation.re), ends.of_from(simd, |pose| pose.rotation.im));
        let to = (ends.of_to(simd, |pose| pose.rotation.re), ends.of_to(simd, |pose| pose.rotation.im));
        let relative = Relative { x, y, cosine: to.0, sine: to.1 }.seen_from(from);
        let measured = (
            ends.of_edge(simd, |edge| edge.measurement.rotation.re),
            ends.of_edge(simd, |edge| edge.measurement.rotation.im),
        );
        let x = relative.x - ends.of_edge(simd, |edge| edge.measurement.translation.x);
        let y = relative.y - ends.of_edge(simd, |edge| edge.measurement.translation.y);
        let Relative { x, y, cosine, sine } = Relative { x, y, ..relative }.seen_from(measured);
        let tangent = sine * (cosine + Lanes::splat(simd, 1.0)).reciprocal();
        let functions = HalfAngle::of_squared_tangent(tangent * tangent);
        if !functions.u.at_most(LARGEST) {
            return None;
        }
        let (a, half) = (functions.a, tangent * functions.a);
        let error = [a.times_plus(x, half * y), a.times_plus(y, -(half * x)), half + half];
        Some(Self { relative, offset: (x, y), functions, tangent, half, error })
    }

    /// `Omega e`.
    #[inline(always)]
    fn pull(&self, information: &[Lanes<S>; 6]) -> [Lanes<S>; 3] {
        let [xx, xy, yy, xt, yt, tt] = *information;
        let [x, y, t] = self.error;
        [
            xx.times_plus(x, xy.times_plus(y, xt * t)),
            xy.times_plus(x, yy.times_plus(y, yt * t)),
            xt.times_plus(x, yt.times_plus(y, tt * t)),
        ]
    }

    /// `e^T Omega e`.
    #[inline(always)]
    fn squared(&self, pull: &[Lanes<S>; 3]) -> Lanes<S> {
        let [x, y, t] = self.error;
        x.times_plus(pull[0], y.times_plus(pull[1], t * pull[2]))
    }

    /// The last column of `J_j = [A, -a/2, j_x; a/2, A, j_y; 0, 0, 1]`.
    #[inline(always)]
    fn jacobian(&self) -> (Lanes<S>, Lanes<S>) {
        let slope = -(self.tangent * self.functions.slope_of_a());
        let half = slope.constant(0.5);
        let (x, y) = self.offset;
        (slope.times_plus(x, half * y), slope.times_plus(y, -(half * x)))
    }

    /// `J_j^T` times a vector.
    #[inline(always)]
    fn by_to(&self, (across, along): (Lanes<S>, Lanes<S>), [x, y, t]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let (a, half) = (self.functions.a, self.half);
        [
            a.times_plus(x, half * y),
            a.times_plus(y, -(half * x)),
            across.times_plus(x, along.times_plus(y, t)),
        ]
    }
}

impl<S: Simd> Relative<S> {
    /// This pose, whose translation is already a difference, in a frame with this cosine and sine.
    #[inline(always)]
    fn seen_from(self, (cosine, sine): (Lanes<S>, Lanes<S>)) -> Self {
        Self {
            x: cosine.times_plus(self.x, sine * self.y),
            y: cosine.times_plus(self.y, -(sine * self.x)),
            cosine: cosine.times_plus(self.cosine, sine * self.sine),
            sine: cosine.times_plus(self.sine, -(sine * self.cosine)),
        }
    }

    /// The last column of `Ad(X_ij^-1) = [R^T, (y, -x); 0, 1]`, where `(x, y) = -R^T t`.
    #[inline(always)]
    fn lever(&self) -> (Lanes<S>, Lanes<S>) {
        let Self { x, y, cosine, sine } = *self;
        (sine.times_plus(x, -(cosine * y)), cosine.times_plus(x, sine * y))
    }

    /// `-Ad(X_ij^-1)^T` times a vector.
    #[inline(always)]
    fn by_from(&self, lever: (Lanes<S>, Lanes<S>), [x, y, t]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let Self { cosine, sine, .. } = *self;
        [
            sine.times_plus(y, -(cosine * x)),
            -(sine.times_plus(x, cosine * y)),
            -(lever.0.times_plus(x, lever.1.times_plus(y, t))),
        ]
    }
}

/// The upper triangles of the information matrices, column by column.
#[inline(always)]
fn information<S: Simd>(simd: S, ends: &Ends<'_, SE2, 3>) -> [Lanes<S>; 6] {
    [
        ends.information(simd, 0, 0),
        ends.information(simd, 0, 1),
        ends.information(simd, 1, 1),
        ends.information(simd, 0, 2),
        ends.information(simd, 1, 2),
        ends.information(simd, 2, 2),
    ]
}

/// The linear models of edges, and what their quadratic models need.
struct Slope<S: Simd> {
    residual: Residual<S>,
    /// The last columns of `J_j` and of `Ad(X_ij^-1)`.
    jacobian: (Lanes<S>, Lanes<S>),
    lever: (Lanes<S>, Lanes<S>),
    information: [Lanes<S>; 6],
    weight: Option<Lanes<S>>,
    /// Half the gradients.
    from: [Lanes<S>; 3],
    to: [Lanes<S>; 3],
    costs: [f64; WIDTH],
}

impl<S: Simd> Slope<S> {
    /// `None` if an error turns too far.
    #[inline(always)]
    fn of(simd: S, ends: &Ends<'_, SE2, 3>) -> Option<Self> {
        let residual = Residual::of(simd, ends)?;
        let information = information(simd, ends);
        let mut pull = residual.pull(&information);
        let (costs, weight) = ends.charge(simd, &residual.squared(&pull));
        if let Some(weight) = weight {
            pull = three!(row => pull[row] * weight);
        }
        let (jacobian, lever) = (residual.jacobian(), residual.relative.lever());
        let to = residual.by_to(jacobian, pull);
        let from = residual.relative.by_from(lever, to);
        Some(Self { residual, jacobian, lever, information, weight, from, to, costs })
    }

    /// The quadratic models.
    #[inline(always)]
    fn models(&self) -> Models<S, 3> {
        let Self { residual, jacobian, lever, .. } = self;
        let [mut xx, mut xy, mut yy, mut xt, mut yt, mut tt] = self.information;
        if let Some(weight) = self.weight {
            [xx, xy, yy] = [xx * weight, xy * weight, yy * weight];
            [xt, yt, tt] = [xt * weight, yt * weight, tt * weight];
        }
        // Columns of `J_j^T Omega`, then rows of `J_j^T Omega J_j`, which is symmetric.
        let x = residual.by_to(*jacobian, [xx, xy, xt]);
        let y = residual.by_to(*jacobian, [xy, yy, yt]);
        let t = residual.by_to(*jacobian, [xt, yt, tt]);
        let to_to = three!(row => residual.by_to(*jacobian, [x[row], y[row], t[row]]));
        // Columns of `-Ad^T (J_j^T Omega J_j)`, then rows of the block at (from, from).
        let relative = residual.relative;
        let from_to = three!(column => relative.by_from(*lever, to_to[column]));
        let from_from =
            three!(row => relative.by_from(*lever, [from_to[0][row], from_to[1][row], from_to[2][row]]));
        Models { from_from, from_to, to_to, from_gradient: self.from, to_gradient: self.to }
    }
}

impl LaneGroup<3> for SE2 {
    #[inline(always)]
    fn costs<S: Simd>(simd: S, edges: &[Edge<Self, 3>], poses: &[Self], costs: &mut [f64]) -> bool {
        let ends = Ends { edges, poses };
        let Some(residual) = Residual::of(simd, &ends) else { return false };
        let squared = residual.squared(&residual.pull(&information(simd, &ends)));
        let (charged, _) = ends.charge(simd, &squared);
        costs.copy_from_slice(&charged[..costs.len()]);
        true
    }

    #[inline(always)]
    fn gradients<S: Simd>(
        simd: S,
        edges: &[Edge<Self, 3>],
        poses: &[Self],
        gradients: &mut [Gradient<3>],
    ) -> bool {
        let Some(slope) = Slope::of(simd, &Ends { edges, poses }) else { return false };
        write_gradients((&slope.from, &slope.to), &slope.costs, gradients);
        true
    }

    #[inline(always)]
    fn models<S: Simd>(
        simd: S,
        edges: &[Edge<Self, 3>],
        poses: &[Self],
        models: &mut [Linearised<3>],
    ) -> bool {
        let Some(slope) = Slope::of(simd, &Ends { edges, poses }) else { return false };
        slope.models().write(&slope.costs, models);
        true
    }

    #[inline(always)]
    fn moved<S: Simd>(simd: S, poses: &[Self], steps: &[Vector3<f64>], moved: &mut [Self]) -> bool {
        let last = steps.len() - 1;
        let step = |axis: usize| Lanes::gather(simd, |lane| steps[lane.min(last)][axis]);
        let (x, y, turn) = (step(0), step(1), step(2));
        let squared = turn * turn;
        if !squared.at_most(SERIES_LIMIT) {
            return false;
        }
        let cosine = even::one_minus(squared, even::second(squared));
        let sine = turn * even::one_minus(squared, even::third(squared));
        let own_cosine = Lanes::gather(simd, |lane| poses[lane.min(last)].rotation.re);
        let own_sine = Lanes::gather(simd, |lane| poses[lane.min(last)].rotation.im);
        let (x, y) = (own_cosine.times_plus(x, -(own_sine * y)), own_sine.times_plus(x, own_cosine * y));
        let re = own_cosine.times_plus(cosine, -(own_sine * sine));
        let im = own_sine.times_plus(cosine, own_cosine * sine);
        // One Newton step towards norm 1, as in `compose`.
        let scale = re.times_plus(re, im * im).times_from(re.constant(0.5), re.constant(1.5));
        let (re, im) = (re * scale, im * scale);
        for (lane, (pose, moved)) in poses.iter().zip(moved).enumerate() {
            let number = |of: &Lanes<S>| of.numbers()[lane];
            moved.translation = pose.translation + Vector2::new(number(&x), number(&y));
            moved.rotation = UnitComplex::new_unchecked(Complex::new(number(&re), number(&im)));
        }
        true
    }
}

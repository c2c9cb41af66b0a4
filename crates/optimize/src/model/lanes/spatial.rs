//! Edges in space, one in each lane.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Simd;
use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector6};
use posecut_geometry::SE3;
use posecut_geometry::trigonometric::SERIES_LIMIT;

use super::half_angle::{HalfAngle, LARGEST};
use super::rotation::Rotation;
use super::vector::{
    Matrix, Vector, cross, dot, dot_plus, minus, negated, outer, plus, plus_cross, plus_diagonal,
    plus_matrix, scaled, scaled_plus, symmetric, times, transposed, transposed_times, transposed_times_plus,
};
use posecut_geometry::lanes::{Lanes, WIDTH};

use super::{Ends, LaneGroup, Models, even, three, write_gradients};
use crate::model::problem::Edge;
use crate::model::quadratic::{Gradient, Linearised};

/// The residuals of edges: `e = Log(Z^-1 X_ij)`, translations before rotations.
struct Residual<S: Simd> {
    /// Translation and rotation of `X_ij`.
    translation: Vector<S>,
    rotation: Rotation<S>,
    functions: HalfAngle<S>,
    /// `h` and its slope.
    h: (Lanes<S>, Lanes<S>),
    shift: Vector<S>,
    turn: Vector<S>,
}

impl<S: Simd> Residual<S> {
    /// `None` if one of them turns too far.
    #[inline(always)]
    fn of(simd: S, ends: &Ends<'_, SE3, 6>) -> Option<Self> {
        let from = Rotation {
            scalar: ends.of_from(simd, |pose| pose.rotation.w),
            vector: three!(axis => ends.of_from(simd, |pose| pose.rotation.coords[axis])),
        };
        let to = Rotation {
            scalar: ends.of_to(simd, |pose| pose.rotation.w),
            vector: three!(axis => ends.of_to(simd, |pose| pose.rotation.coords[axis])),
        };
        let origin = three!(axis => ends.of_from(simd, |pose| pose.translation[axis]));
        let goal = three!(axis => ends.of_to(simd, |pose| pose.translation[axis]));
        let translation = from.back(minus(goal, origin));
        let rotation = from.between(to);
        let measured = Rotation {
            scalar: ends.of_edge(simd, |edge| edge.measurement.rotation.w),
            vector: three!(axis => ends.of_edge(simd, |edge| edge.measurement.rotation.coords[axis])),
        };
        let expected = three!(axis => ends.of_edge(simd, |edge| edge.measurement.translation[axis]));
        let offset = minus(translation, expected);
        let offset = measured.back(offset);
        let turned = measured.between(rotation);
        let tangent = scaled(turned.vector, turned.scalar.reciprocal());
        let functions = HalfAngle::of_squared_tangent(dot(tangent, tangent));
        if !functions.u.at_most(LARGEST) {
            return None;
        }
        // `p = V^-1 t = t - r x t / 2 + h r x (r x t)`.
        let half = scaled(tangent, functions.a);
        let turn = plus(half, half);
        let h = functions.half_cotangent();
        let once = cross(half, offset);
        let twice = cross(turn, once);
        let shift = scaled_plus(twice, h.0 + h.0, minus(offset, once));
        Some(Self { translation, rotation, functions, h, shift, turn })
    }

    /// The blocks `D` and `U` of `J_j = [D, U; 0, D]`: see `SE3::log_with_jacobian`.
    #[inline(always)]
    fn jacobian(&self) -> (Matrix<S>, Matrix<S>) {
        let Self { shift: p, turn: r, h: (h, slope), functions: HalfAngle { u, a, .. }, .. } = *self;
        let one = u.constant(1.0);
        let half = u.constant(0.5);
        let squared = u * a * a * u.constant(4.0);
        let along = dot(r, p);
        let bend = (slope + slope) * along;
        let sides = -((along + along) * h);
        let weighted = scaled(r, h);
        let bent = scaled_plus(p, h, scaled(r, bend));
        let middle = h.times_from(squared, one);
        let middle_upper = bend.times_from(squared, sides);
        let diagonal = outer(weighted, r);
        let upper = plus_matrix(&outer(bent, r), &outer(weighted, p));
        (
            plus_cross(&plus_diagonal(&diagonal, middle), scaled(r, half)),
            plus_cross(&plus_diagonal(&upper, middle_upper), scaled(p, half)),
        )
    }
}

/// The information matrices `[a, b; b^T, c]`.
struct Information<S: Simd> {
    a: Matrix<S>,
    b: Matrix<S>,
    c: Matrix<S>,
}

impl<S: Simd> Information<S> {
    #[inline(always)]
    fn of(simd: S, ends: &Ends<'_, SE3, 6>) -> Self {
        Self {
            a: three!(column => three!(row => ends.information(simd, row.min(column), row.max(column)))),
            b: three!(column => three!(row => ends.information(simd, row, 3 + column))),
            c: three!(column => three!(row => ends.information(simd, 3 + row.min(column), 3 + row.max(column)))),
        }
    }

    /// `Omega e`.
    #[inline(always)]
    fn pull(&self, residual: &Residual<S>) -> (Vector<S>, Vector<S>) {
        let Residual { shift, turn, .. } = residual;
        (
            transposed_times_plus(&self.a, *shift, times(&self.b, *turn)),
            transposed_times_plus(&self.b, *shift, transposed_times(&self.c, *turn)),
        )
    }
}

/// `e^T Omega e`.
#[inline(always)]
fn squared<S: Simd>(residual: &Residual<S>, pull: &(Vector<S>, Vector<S>)) -> Lanes<S> {
    dot(residual.shift, pull.0) + dot(residual.turn, pull.1)
}

/// `-Ad(X_ij^-1)^T g`, where `Ad(X_ij^-1)^T = [R, 0; [t] R, R]`.
#[inline(always)]
fn by_from<S: Simd>(
    rotation: &Matrix<S>,
    translation: Vector<S>,
    (first, second): (Vector<S>, Vector<S>),
) -> (Vector<S>, Vector<S>) {
    let shift = negated(times(rotation, first));
    (shift, minus(cross(translation, shift), times(rotation, second)))
}

/// The joined entries.
#[inline(always)]
fn joined<S: Simd>(([a, b, c], [d, e, f]): (Vector<S>, Vector<S>)) -> [Lanes<S>; 6] {
    [a, b, c, d, e, f]
}

/// The columns of `[a, c; b, d]`.
#[inline(always)]
fn joined_blocks<S: Simd>([a, b, c, d]: [&Matrix<S>; 4]) -> [[Lanes<S>; 6]; 6] {
    [
        joined((a[0], b[0])),
        joined((a[1], b[1])),
        joined((a[2], b[2])),
        joined((c[0], d[0])),
        joined((c[1], d[1])),
        joined((c[2], d[2])),
    ]
}

/// The linear models of edges, and what their quadratic models need.
struct Slope<S: Simd> {
    /// `X_ij`.
    rotation: Matrix<S>,
    translation: Vector<S>,
    /// The blocks `D` and `U` of `J_j`.
    jacobian: (Matrix<S>, Matrix<S>),
    information: Information<S>,
    weight: Option<Lanes<S>>,
    /// Half the gradients.
    from: (Vector<S>, Vector<S>),
    to: (Vector<S>, Vector<S>),
    costs: [f64; WIDTH],
}

impl<S: Simd> Slope<S> {
    /// `None` if an error turns too far.
    #[inline(always)]
    fn of(simd: S, ends: &Ends<'_, SE3, 6>) -> Option<Self> {
        let residual = Residual::of(simd, ends)?;
        let information = Information::of(simd, ends);
        let mut pull = information.pull(&residual);
        let (costs, weight) = ends.charge(simd, &squared(&residual, &pull));
        if let Some(weight) = weight {
            pull = (scaled(pull.0, weight), scaled(pull.1, weight));
        }
        let (diagonal, upper) = residual.jacobian();
        let to = (
            transposed_times(&diagonal, pull.0),
            transposed_times_plus(&upper, pull.0, transposed_times(&diagonal, pull.1)),
        );
        let (rotation, translation) = (residual.rotation.matrix(), residual.translation);
        let from = by_from(&rotation, translation, to);
        Some(Self {
            rotation,
            translation,
            jacobian: (diagonal, upper),
            information,
            weight,
            from,
            to,
            costs,
        })
    }

    /// The blocks of `J_j^T w Omega J_j = [m, n; n^T, o]`, from the columns of `Omega J_j = [a D, a U + b D; b^T D, b^T U + c D]`, of which
    /// the lower left block is not needed.
    #[inline(always)]
    fn curvature(&self) -> [Matrix<S>; 3] {
        let Self { jacobian: (diagonal, upper), information: Information { a, b, c }, .. } = self;
        let weight = self.weight.unwrap_or(self.translation[0].constant(1.0));
        let left = three!(column => scaled(transposed_times(a, diagonal[column]), weight));
        let right = three!(column => {
            scaled(transposed_times_plus(a, upper[column], times(b, diagonal[column])), weight)
        });
        let lower = three!(column => {
            scaled(transposed_times_plus(b, upper[column], transposed_times(c, diagonal[column])), weight)
        });
        [
            symmetric!(row, column => dot(diagonal[row], left[column])),
            three!(column => transposed_times(diagonal, right[column])),
            symmetric!(row, column => {
                dot_plus(upper[row], right[column], dot(diagonal[row], lower[column]))
            }),
        ]
    }
}

impl LaneGroup<6> for SE3 {
    #[inline(always)]
    fn costs<S: Simd>(simd: S, edges: &[Edge<Self, 6>], poses: &[Self], costs: &mut [f64]) -> bool {
        let ends = Ends { edges, poses };
        let Some(residual) = Residual::of(simd, &ends) else { return false };
        let pull = Information::of(simd, &ends).pull(&residual);
        let (charged, _) = ends.charge(simd, &squared(&residual, &pull));
        costs.copy_from_slice(&charged[..costs.len()]);
        true
    }

    #[inline(always)]
    fn gradients<S: Simd>(
        simd: S,
        edges: &[Edge<Self, 6>],
        poses: &[Self],
        gradients: &mut [Gradient<6>],
    ) -> bool {
        let Some(slope) = Slope::of(simd, &Ends { edges, poses }) else { return false };
        write_gradients((&joined(slope.from), &joined(slope.to)), &slope.costs, gradients);
        true
    }

    #[inline(always)]
    fn models<S: Simd>(
        simd: S,
        edges: &[Edge<Self, 6>],
        poses: &[Self],
        models: &mut [Linearised<6>],
    ) -> bool {
        let Some(slope) = Slope::of(simd, &Ends { edges, poses }) else { return false };
        let [m, n, o] = slope.curvature();
        let Slope { rotation, translation, from, to, costs, .. } = slope;
        let n_transposed = transposed(&n);
        // `Ad^T (J_j^T Omega J_j) = [R m, R n; [t] R m + R n^T, [t] R n + R o]`.
        let r_m = three!(column => times(&rotation, m[column]));
        let r_n = three!(column => times(&rotation, n[column]));
        let lower_left = three!(column => {
            plus(cross(translation, r_m[column]), times(&rotation, n_transposed[column]))
        });
        let lower_right = three!(column => {
            plus(cross(translation, r_n[column]), times(&rotation, o[column]))
        });
        // Rows of `R`, `R m` and `R n`, then those of `R m R^T` and `R n R^T`.
        let (turn, m_rows, n_rows) = (transposed(&rotation), transposed(&r_m), transposed(&r_n));
        let first = symmetric!(row, column => dot(m_rows[row], turn[column]));
        let second = three!(row => times(&rotation, n_rows[row]));
        // The block of first and second axes: `R n R^T - R m R^T [t]`.
        let upper_right = three!(row => plus(second[row], cross(translation, first[row])));
        // The last block, `([t] R n + R o) R^T - F_21 [t]`. A row times `-[t]` is `t x` the row, and rows of `F_21` are columns of `F_12`.
        let (left_rows, lower_rows) = (transposed(&upper_right), transposed(&lower_right));
        let bent = three!(row => cross(translation, left_rows[row]));
        let corner = symmetric!(row, column => dot_plus(lower_rows[row], turn[column], bent[row][column]));
        Models {
            from_from: joined_blocks([&first, &upper_right, &left_rows, &corner]),
            from_to: joined_blocks([
                &three!(column => negated(r_m[column])),
                &three!(column => negated(lower_left[column])),
                &three!(column => negated(r_n[column])),
                &three!(column => negated(lower_right[column])),
            ]),
            to_to: joined_blocks([&m, &n_transposed, &n, &o]),
            from_gradient: joined(from),
            to_gradient: joined(to),
        }
        .write(&costs, models);
        true
    }

    #[inline(always)]
    fn moved<S: Simd>(simd: S, poses: &[Self], steps: &[Vector6<f64>], moved: &mut [Self]) -> bool {
        let last = steps.len() - 1;
        let shift = three!(axis => Lanes::gather(simd, |lane| steps[lane.min(last)][axis]));
        let turn = three!(axis => Lanes::gather(simd, |lane| steps[lane.min(last)][3 + axis]));
        let squared = dot(turn, turn);
        if !squared.at_most(SERIES_LIMIT) {
            return false;
        }
        // `sin(a/2) / a` and `cos(a/2)` of the quaternion.
        let quarter = squared * squared.constant(0.25);
        let half_sine = even::one_minus(quarter, even::third(quarter)) * squared.constant(0.5);
        let half_cosine = even::one_minus(quarter, even::second(quarter));
        let own = Rotation {
            scalar: Lanes::gather(simd, |lane| poses[lane.min(last)].rotation.w),
            vector: three!(axis => Lanes::gather(simd, |lane| poses[lane.min(last)].rotation.coords[axis])),
        };
        let shift = own.inverse().back(shift);
        let step = Rotation { scalar: half_cosine, vector: scaled(turn, half_sine) };
        let Rotation { scalar, vector } = own.inverse().between(step);
        // One Newton step towards norm 1, as in `compose`.
        let norm = scalar.times_plus(scalar, dot(vector, vector));
        let scale = norm.times_from(norm.constant(0.5), norm.constant(1.5));
        let (scalar, vector) = (scalar * scale, scaled(vector, scale));
        for (lane, (pose, moved)) in poses.iter().zip(moved).enumerate() {
            let number = |of: &Lanes<S>| of.numbers()[lane];
            let [x, y, z] = &shift;
            moved.translation = pose.translation + Vector3::new(number(x), number(y), number(z));
            let [x, y, z] = &vector;
            let rotation = Quaternion::new(number(&scalar), number(x), number(y), number(z));
            moved.rotation = UnitQuaternion::new_unchecked(rotation);
        }
        true
    }
}

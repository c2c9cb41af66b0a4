//! The motion that brings one set of points closest to another.

use nalgebra::{Matrix2, Matrix3, Rotation3, Vector2, Vector3};
use serde::Serialize;

/// Which motions an alignment may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Freedom {
    /// No motion: the poses are compared unchanged
    #[serde(rename = "none")]
    None,
    /// Rotations about the vertical axis, and translations
    #[serde(rename = "SE(2)")]
    Se2,
    /// Rigid motions
    #[serde(rename = "SE(3)")]
    Se3,
    /// Rigid motions and a scale
    #[serde(rename = "Sim(3)")]
    Sim3,
}

impl Freedom {
    /// The name in results and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "no",
            Self::Se2 => "SE(2)",
            Self::Se3 => "SE(3)",
            Self::Sim3 => "Sim(3)",
        }
    }
}

/// p -> scale * rotation * p + translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// Rotates the estimate's frame into the reference's.
    pub rotation: Rotation3<f64>,
    /// In metres, in the reference's frame.
    pub translation: Vector3<f64>,
    /// 1 unless the freedom includes a scale.
    pub scale: f64,
}

impl Alignment {
    /// The alignment that does not move points.
    pub fn identity() -> Self {
        Self { rotation: Rotation3::identity(), translation: Vector3::zeros(), scale: 1.0 }
    }

    /// Moves a point.
    pub fn apply(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.scale * (self.rotation * point) + self.translation
    }

    /// The alignment of `from` to `to` with the smallest sum of squared distances (Umeyama, PAMI 13(4), 1991, equations
    /// 40-42). With the centred cross-covariance M = U D V^T of the points, R = U S V^T where S flips the last axis if
    /// needed to keep R a rotation, s = tr(D S) / variance, t = mean - s R mean. If there are no points or all
    /// coincide, the rotation is the identity. Both slices must have the same length.
    pub fn best(from: &[Vector3<f64>], to: &[Vector3<f64>], freedom: Freedom) -> Self {
        if freedom == Freedom::None || from.is_empty() {
            return Self::identity();
        }
        let count = from.len() as f64;
        let mean_from = from.iter().sum::<Vector3<f64>>() / count;
        let mean_to = to.iter().sum::<Vector3<f64>>() / count;
        let mut cross = Matrix3::zeros();
        let mut variance = 0.0;
        for (p, q) in from.iter().zip(to) {
            let centred = p - mean_from;
            cross += (q - mean_to) * centred.transpose() / count;
            variance += centred.norm_squared() / count;
        }
        let (rotation, trace) = match freedom {
            Freedom::Se2 => (turn_about_vertical(&cross), 0.0),
            _ => rotation(&cross),
        };
        let scale = if freedom == Freedom::Sim3 && variance > 0.0 { trace / variance } else { 1.0 };
        Self { rotation, translation: mean_to - scale * (rotation * mean_from), scale }
    }
}

/// The rotation closest to a cross-covariance, and tr(D S).
fn rotation(cross: &Matrix3<f64>) -> (Rotation3<f64>, f64) {
    let decomposition = cross.svd(true, true);
    let (Some(u), Some(v_transposed)) = (decomposition.u, decomposition.v_t) else {
        return (Rotation3::identity(), 0.0);
    };
    // Singular values are in descending order, so the flipped axis is the least important one.
    let mut signs = Vector3::new(1.0, 1.0, 1.0);
    if (u * v_transposed).determinant() < 0.0 {
        signs[2] = -1.0;
    }
    let matrix = u * Matrix3::from_diagonal(&signs) * v_transposed;
    let trace = decomposition.singular_values.component_mul(&signs).sum();
    (Rotation3::from_matrix_unchecked(matrix), trace)
}

/// In the plane the best rotation has a closed form: the angle of the sum of all rotations.
fn turn_about_vertical(cross: &Matrix3<f64>) -> Rotation3<f64> {
    let plane: Matrix2<f64> = cross.fixed_view::<2, 2>(0, 0).into_owned();
    let turn = Vector2::new(plane[(0, 0)] + plane[(1, 1)], plane[(1, 0)] - plane[(0, 1)]);
    Rotation3::from_axis_angle(&Vector3::z_axis(), turn.y.atan2(turn.x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points() -> impl Strategy<Value = Vec<Vector3<f64>>> {
        let point =
            (-50.0_f64..50.0, -50.0_f64..50.0, -50.0_f64..50.0).prop_map(|(x, y, z)| Vector3::new(x, y, z));
        proptest::collection::vec(point, 4..12)
    }

    fn sum_of_squares(alignment: &Alignment, from: &[Vector3<f64>], to: &[Vector3<f64>]) -> f64 {
        from.iter().zip(to).map(|(p, q)| (alignment.apply(p) - q).norm_squared()).sum()
    }

    proptest! {
        #[test]
        fn a_known_similarity_is_found_again(
            from in points(),
            axis in (-3.1_f64..3.1, -3.1_f64..3.1, -3.1_f64..3.1),
            shift in (-9.0_f64..9.0, -9.0_f64..9.0, -9.0_f64..9.0),
            scale in 0.2_f64..5.0,
        ) {
            let known = Alignment {
                rotation: Rotation3::new(Vector3::new(axis.0, axis.1, axis.2)),
                translation: Vector3::new(shift.0, shift.1, shift.2),
                scale,
            };
            let to: Vec<_> = from.iter().map(|p| known.apply(p)).collect();
            let found = Alignment::best(&from, &to, Freedom::Sim3);
            prop_assert!((found.scale - scale).abs() < 1e-9 * scale);
            prop_assert!(sum_of_squares(&found, &from, &to) < 1e-15 * scale * scale * 1e4 * from.len() as f64);
        }

        #[test]
        fn no_small_change_makes_it_better(
            from in points(), to in points(), wiggle in proptest::array::uniform7(-0.01_f64..0.01),
        ) {
            let count = from.len().min(to.len());
            let (from, to) = (&from[..count], &to[..count]);
            for freedom in [Freedom::Se2, Freedom::Se3, Freedom::Sim3] {
                let best = Alignment::best(from, to, freedom);
                let turn = match freedom {
                    Freedom::Se2 => Vector3::new(0.0, 0.0, wiggle[2]),
                    _ => Vector3::new(wiggle[0], wiggle[1], wiggle[2]),
                };
                let other = Alignment {
                    rotation: Rotation3::new(turn) * best.rotation,
                    translation: best.translation + Vector3::new(wiggle[3], wiggle[4], wiggle[5]),
                    scale: if freedom == Freedom::Sim3 { best.scale + wiggle[6] } else { 1.0 },
                };
                let (best, other) = (sum_of_squares(&best, from, to), sum_of_squares(&other, from, to));
                prop_assert!(best <= other * (1.0 + 1e-12), "{:?}: {} > {}", freedom, best, other);
            }
        }
    }

    #[test]
    fn a_mirrored_set_is_not_aligned_by_a_reflection() {
        let from = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0], [0.0, 0.0, 0.0]].map(Vector3::from);
        let to = from.map(|p| Vector3::new(-p.x, p.y, p.z));
        let best = Alignment::best(&from, &to, Freedom::Se3);
        assert!((best.rotation.matrix().determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn no_points_and_one_point_are_no_fault() {
        assert_eq!(Alignment::best(&[], &[], Freedom::Se3), Alignment::identity());
        let one = Alignment::best(&[Vector3::x()], &[Vector3::y()], Freedom::Se3);
        assert!((one.apply(&Vector3::x()) - Vector3::y()).norm() < 1e-12);
    }
}

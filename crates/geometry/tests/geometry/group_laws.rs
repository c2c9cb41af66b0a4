//! Laws of a Lie group, for angles of both signs, tiny ones and ones near pi.

use crate::homogeneous::{Homogeneous, matrix_exponential};
use crate::tangents::{planar_tangent, spatial_tangent};
use nalgebra::SVector;
use posecut_geometry::{LieGroup, SE2, SE3};
use proptest::prelude::*;

/// Norm of the difference of two poses.
fn distance<G: LieGroup<DOF>, const DOF: usize>(first: &G, second: &G) -> f64 {
    first.between(second).log().norm()
}

macro_rules! laws {
    ($group:ident, $dof:literal, $tangent:ident, $module:ident) => {
        mod $module {
            use super::*;

            proptest! {
                #![proptest_config(ProptestConfig::with_cases(2000))]

                #[test]
                fn composition_is_associative(a in $tangent(), b in $tangent(), c in $tangent()) {
                    let (a, b, c) = ($group::exp(&a), $group::exp(&b), $group::exp(&c));
                    let left = a.compose(&b).compose(&c);
                    let right = a.compose(&b.compose(&c));
                    prop_assert!(distance(&left, &right) < 1e-12, "{left:?} {right:?}");
                }

                #[test]
                fn identity_and_inverse_are_neutral(a in $tangent()) {
                    let a = $group::exp(&a);
                    prop_assert!(distance(&a.compose(&$group::identity()), &a) < 1e-13);
                    prop_assert!(distance(&$group::identity().compose(&a), &a) < 1e-13);
                    prop_assert!(a.compose(&a.inverse()).log().norm() < 1e-12);
                    prop_assert!(a.inverse().compose(&a).log().norm() < 1e-12);
                }

                #[test]
                fn between_solves_for_the_second_pose(a in $tangent(), b in $tangent()) {
                    let (a, b) = ($group::exp(&a), $group::exp(&b));
                    prop_assert!(distance(&a.compose(&a.between(&b)), &b) < 1e-12);
                }

                #[test]
                fn log_undoes_exp(tangent in $tangent()) {
                    let back = $group::exp(&tangent).log();
                    prop_assert!((back - tangent).norm() < 1e-12, "{tangent} {back}");
                }

                #[test]
                fn exp_undoes_log(tangent in $tangent(), other in $tangent()) {
                    // A product reaches rotations that no single random tangent vector reaches.
                    let pose = $group::exp(&tangent).compose(&$group::exp(&other));
                    let back = $group::exp(&pose.log());
                    for (first, second) in pose.homogeneous().iter().zip(back.homogeneous().iter()) {
                        prop_assert!((first - second).abs() < 1e-12, "{pose:?} {back:?}");
                    }
                }

                #[test]
                fn exp_is_the_series_of_the_matrix(tangent in $tangent()) {
                    let series = matrix_exponential(&$group::algebra(&tangent));
                    let closed = $group::exp(&tangent).homogeneous();
                    prop_assert!((&series - &closed).amax() < 1e-12, "{tangent} {series} {closed}");
                }

                #[test]
                fn adjoint_moves_a_perturbation_past_a_pose(pose in $tangent(), small in $tangent()) {
                    let pose = $group::exp(&pose);
                    let tangent = small * 0.25;
                    let moved = pose.compose(&$group::exp(&tangent)).compose(&pose.inverse()).log();
                    prop_assert!((pose.adjoint() * tangent - moved).norm() < 1e-11);
                }

                #[test]
                fn left_jacobian_is_the_adjoint_of_the_right_one(tangent in $tangent()) {
                    let left = $group::left_jacobian(&tangent);
                    let right = $group::exp(&tangent).adjoint() * $group::right_jacobian(&tangent);
                    prop_assert!((left - right).amax() < 1e-12, "{left} {right}");
                }

                #[test]
                fn inverse_jacobians_are_inverses(tangent in $tangent()) {
                    let identity = nalgebra::SMatrix::<f64, $dof, $dof>::identity();
                    let left = $group::left_jacobian_inverse(&tangent) * $group::left_jacobian(&tangent);
                    let right = $group::right_jacobian_inverse(&tangent) * $group::right_jacobian(&tangent);
                    prop_assert!((left - identity).amax() < 1e-12, "{left}");
                    prop_assert!((right - identity).amax() < 1e-12, "{right}");
                }

                #[test]
                fn the_logarithm_with_its_jacobian_is_both_apart(tangent in $tangent(), size in 0.0..1.0) {
                    let pose = $group::exp(&(tangent * size * size));
                    let (log, jacobian) = pose.log_with_jacobian();
                    prop_assert_eq!(log, pose.log());
                    let apart = $group::right_jacobian_inverse(&log);
                    prop_assert!((jacobian - apart).amax() < 1e-12 * (1.0 + log.amax()), "{jacobian} {apart}");
                }

                #[test]
                fn jacobians_are_derivatives_of_exp(tangent in $tangent(), axis in 0_usize..$dof) {
                    let step = 1e-5;
                    let mut forward = tangent;
                    let mut backward = tangent;
                    forward[axis] += step;
                    backward[axis] -= step;
                    let pose = $group::exp(&tangent);
                    let right: SVector<f64, $dof> = (pose.between(&$group::exp(&forward)).log()
                        - pose.between(&$group::exp(&backward)).log()) / (2.0 * step);
                    prop_assert!((right - $group::right_jacobian(&tangent).column(axis)).amax() < 1e-8);
                    let left: SVector<f64, $dof> = ($group::exp(&forward).compose(&pose.inverse()).log()
                        - $group::exp(&backward).compose(&pose.inverse()).log()) / (2.0 * step);
                    prop_assert!((left - $group::left_jacobian(&tangent).column(axis)).amax() < 1e-8);
                }

                #[test]
                fn interpolation_meets_its_ends_at_constant_speed(a in $tangent(), b in $tangent(), s in 0.0..1.0) {
                    let (a, b) = ($group::exp(&a), $group::exp(&b));
                    prop_assert!(distance(&a.interpolate(&b, 0.0), &a) < 1e-13);
                    prop_assert!(distance(&a.interpolate(&b, 1.0), &b) < 1e-11);
                    let part = a.between(&a.interpolate(&b, s)).log();
                    prop_assert!((part - a.between(&b).log() * s).norm() < 1e-11);
                }

                #[test]
                fn components_survive_a_round_trip(tangent in $tangent()) {
                    let pose = $group::exp(&tangent);
                    let components = pose.components();
                    prop_assert_eq!(components.len(), $group::COMPONENTS);
                    let back = $group::from_components(&components).unwrap();
                    prop_assert!(distance(&pose, &back) < 1e-14);
                }
            }
        }
    };
}

laws!(SE2, 3, planar_tangent, plane);
laws!(SE3, 6, spatial_tangent, space);

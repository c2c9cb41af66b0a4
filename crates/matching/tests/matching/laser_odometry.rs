//! Steps by odometry and scan matching together.

use nalgebra::{Matrix3, Vector3};
use posecut_geometry::{LieGroup, SE2};
use posecut_matching::laser_odometry::{Measured, by_matching};
use posecut_random::random;

use crate::rooms::{corridor, room, scan};

/// Odometry with these standard deviations of translation and rotation, metres and radians.
fn odometry(motion: SE2, [translation, rotation]: [f64; 2]) -> Measured {
    let deviations = Vector3::new(translation, translation, rotation);
    Measured { motion, information: Matrix3::from_diagonal(&deviations.map(|one| 1.0 / (one * one))) }
}

/// Where the first scan is taken.
fn first() -> SE2 {
    SE2::new(-2.0, -1.0, 0.2)
}

/// The normalised square of the difference from a measured step to a motion.
fn square(measured: &Measured, motion: &SE2) -> f64 {
    let error = measured.motion.between(motion).log();
    error.dot(&(measured.information * error))
}

#[test]
fn the_step_of_a_wheel_that_slipped_is_where_the_scans_say_and_reaches_to_the_odometry() {
    let mut random = random(5, "laser odometry");
    let walls = room();
    // Within the first window around the odometry, and beyond it.
    for slip in [0.4, 2.5] {
        let motion = SE2::new(0.3, 0.1, 0.1);
        let first = first();
        let scans = [first, first.compose(&motion)].map(|pose| scan(&walls, &pose, 0.01, &mut random));
        let wheels = odometry(motion.compose(&SE2::new(slip, 0.0, 0.0)), [0.02, 0.01]);
        let (measured, comparison) = by_matching(&[wheels], &[Some(&scans[0]), Some(&scans[1])]);
        assert_eq!((comparison.matched, comparison.contradicting), (0, 1), "slip of {slip} m");
        let error = measured[0].motion.between(&motion).log();
        assert!(error.amax() < 0.03, "slip of {slip} m: {error}");
        // The covariance has the difference as one standard deviation.
        let reach = square(&measured[0], &wheels.motion);
        assert!((0.8..1.0).contains(&reach), "slip of {slip} m: {reach}");
    }
}

#[test]
fn along_a_corridor_the_odometry_decides() {
    let mut random = random(6, "laser odometry");
    let walls = corridor();
    let motion = SE2::new(0.5, 0.02, 0.05);
    let scans = [SE2::identity(), motion].map(|pose| scan(&walls, &pose, 0.01, &mut random));
    let wheels = odometry(SE2::new(0.53, 0.08, 0.07), [0.05, 0.02]);
    let (measured, comparison) = by_matching(&[wheels], &[Some(&scans[0]), Some(&scans[1])]);
    assert_eq!(comparison.matched, 1);
    let found = measured[0].motion;
    assert!((found.translation.x - 0.53).abs() < 0.01, "{}", found.translation);
    assert!((found.translation.y - 0.02).abs() < 0.02 && (found.angle() - 0.05).abs() < 0.005, "{found:?}");
}

#[test]
fn without_a_scan_the_step_is_that_of_the_odometry() {
    let mut random = random(7, "laser odometry");
    let one = scan(&room(), &first(), 0.01, &mut random);
    let wheels = odometry(SE2::new(0.5, 0.0, 0.0), [0.05, 0.02]);
    for scans in [[Some(&one), None], [None, Some(&one)], [None, None]] {
        let (measured, comparison) = by_matching(&[wheels], &scans);
        assert_eq!((&measured[..], comparison.unmatched), (&[wheels][..], 1));
    }
    assert_eq!(by_matching(&[], &[]).0, []);
}

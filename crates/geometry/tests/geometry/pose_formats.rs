//! Stored components, Euler angles, angles of the plane, and conversions between plane and space.

use nalgebra::{UnitQuaternion, Vector3};
use posecut_geometry::interpolation::sample;
use posecut_geometry::{LieGroup, SE2, SE3, wrap_angle};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn components_of_the_wrong_length_or_not_finite_are_refused() {
    assert!(SE2::from_components(&[1.0, 2.0]).is_none());
    assert!(SE2::from_components(&[1.0, f64::NAN, 0.0]).is_none());
    assert!(SE2::from_components(&[1.0, 2.0, f64::INFINITY]).is_none());
    assert!(SE3::from_components(&[0.0; 3]).is_none());
    assert!(SE3::from_components(&[0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0, 1.0]).is_none());
}

#[test]
fn quaternions_are_normalised_within_a_thousandth_and_refused_beyond() {
    let near = SE3::from_components(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.000_9, 1.000_5]).unwrap();
    assert!((near.rotation.norm() - 1.0).abs() < 1e-15);
    assert!(SE3::from_components(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.002]).is_none());
    assert!(SE3::from_components(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).is_none());
}

#[test]
fn theta_lies_above_minus_pi_up_to_pi() {
    assert_eq!(wrap_angle(-PI), PI);
    assert_eq!(wrap_angle(PI), PI);
    assert_eq!(wrap_angle(3.0 * PI), PI);
    assert_eq!(wrap_angle(-5.0 * PI), PI);
    assert!(wrap_angle(f64::NAN).is_nan());
    assert!(wrap_angle(f64::INFINITY).is_nan());
    let back = SE2::from_components(&[0.0, 0.0, -PI]).unwrap().components()[2];
    assert!(back > -PI && (back.abs() - PI).abs() < 1e-15);
    assert_eq!(SE2::new(0.0, 0.0, -0.5).components()[2], -0.5);
}

#[test]
fn euler_angles_turn_roll_first_and_yaw_last() {
    let (roll, pitch, yaw) = (0.3, -0.4, 2.9);
    let expected = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
        * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll);
    let pose = SE3::from_euler(1.0, 2.0, 3.0, roll, pitch, yaw);
    assert!(pose.rotation.angle_to(&expected) < 1e-15);
    assert_eq!(pose.translation(), [1.0, 2.0, 3.0]);
}

#[test]
fn pitch_of_a_right_angle_still_gives_angles_of_the_same_rotation() {
    for pitch in [FRAC_PI_2, -FRAC_PI_2] {
        let pose = SE3::from_euler(0.0, 0.0, 0.0, 0.4, pitch, 1.1);
        let (roll, back, yaw) = pose.euler();
        let again = SE3::from_euler(0.0, 0.0, 0.0, roll, back, yaw);
        assert_eq!(roll, 0.0);
        assert!(pose.between(&again).rotation_angle() < 1e-7, "{pitch}");
    }
}

#[test]
fn a_track_is_sampled_at_and_between_its_stamps_but_not_outside() {
    let poses = [SE2::new(0.0, 0.0, 3.0), SE2::new(1.0, 0.0, -3.0), SE2::new(5.0, 0.0, -3.0)];
    let stamps = [i64::MIN, 0, 4];
    assert_eq!(sample(&stamps, &poses, i64::MIN), Some(poses[0]));
    assert_eq!(sample(&stamps, &poses, 4), Some(poses[2]));
    assert!((sample(&stamps, &poses, 1).unwrap().translation.x - 2.0).abs() < 1e-12);
    // The shorter way from 3 to -3 radians leads through pi.
    assert!((sample(&stamps, &poses, i64::MIN / 2).unwrap().rotation_angle() - PI).abs() < 1e-12);
    assert_eq!(sample(&stamps, &poses, 5), None);
    assert_eq!(sample(&stamps[1..], &poses[1..], -1), None);
    assert_eq!(sample(&stamps, &poses[1..], 1), None);
    assert_eq!(sample::<SE2, 3>(&[], &[], 0), None);
}

proptest! {
    #[test]
    fn wrapped_angles_are_the_same_direction(angle in -1e3..1e3_f64) {
        let wrapped = wrap_angle(angle);
        prop_assert!(wrapped > -PI && wrapped <= PI);
        prop_assert!((wrapped.sin() - angle.sin()).abs() < 1e-12 && (wrapped.cos() - angle.cos()).abs() < 1e-12);
    }

    #[test]
    fn euler_angles_survive_a_round_trip(roll in -3.1..3.1_f64, pitch in -1.5..1.5_f64, yaw in -3.1..3.1_f64) {
        let (r, p, y) = SE3::from_euler(0.0, 0.0, 0.0, roll, pitch, yaw).euler();
        prop_assert!((r - roll).abs() < 1e-12 && (p - pitch).abs() < 1e-12 && (y - yaw).abs() < 1e-12);
    }

    /// Stages pass poses on unchanged, so a second reading must not change a bit.
    #[test]
    fn reading_a_written_quaternion_keeps_its_bits(roll in -3.1..3.1_f64, pitch in -1.5..1.5_f64, yaw in -3.1..3.1_f64) {
        let mut components = SE3::from_euler(1.0, 2.0, 3.0, roll, pitch, yaw).components();
        components[6] += 1e-5;
        let first = SE3::from_components(&components).unwrap().components();
        let second = SE3::from_components(&first).unwrap().components();
        prop_assert_eq!(first, second);
    }

    #[test]
    fn plane_is_a_subgroup_of_space(a in (-9.0..9.0_f64, -9.0..9.0_f64, -3.1..3.1_f64),
                                    b in (-9.0..9.0_f64, -9.0..9.0_f64, -3.1..3.1_f64)) {
        let (a, b) = (SE2::new(a.0, a.1, a.2), SE2::new(b.0, b.1, b.2));
        let planar = a.between(&b);
        let spatial = a.to_spatial().between(&b.to_spatial());
        prop_assert!(planar.between(&spatial.to_planar()).log().norm() < 1e-12);
        let (short, long) = (planar.log(), spatial.log());
        prop_assert!((long[0] - short[0]).abs() + (long[1] - short[1]).abs() + (long[5] - short[2]).abs() < 1e-11);
        prop_assert_eq!(long[2], 0.0);
    }

    #[test]
    fn angle_magnitudes_agree_with_the_logarithm(roll in -3.1..3.1_f64, pitch in -1.5..1.5_f64, yaw in -3.1..3.1_f64) {
        let pose = SE3::from_euler(1.0, 0.0, 0.0, roll, pitch, yaw);
        prop_assert!((pose.log().fixed_rows::<3>(3).norm() - pose.rotation_angle()).abs() < 1e-14);
    }
}

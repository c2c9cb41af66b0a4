//! Thinning of clouds.

use nalgebra::Vector2;
use posecut_geometry::SE2;
use posecut_matching::Cloud;

use crate::rooms::{room, scan};

/// The cloud of two scans of the room, as from a scanner that reports whole centimetres, with the second one's pose a little off.
fn two_scans(off: f64) -> Cloud {
    let mut random = posecut_random::random(3, "thinning");
    let mut cloud = Cloud::default();
    for pose in [SE2::new(0.0, 0.0, 0.0), SE2::new(0.5, 0.25, 0.0)] {
        let mut scan = scan(&room(), &pose, 0.01, &mut random);
        scan.first_angle = 0.0;
        for range in &mut scan.ranges {
            *range = (*range * 100.0).round() / 100.0;
        }
        let pose = SE2::new(pose.translation.x + off, pose.translation.y - off, off);
        cloud.add(&Cloud::of_scan(&scan), &pose);
    }
    cloud
}

/// A log's poses differ in their last bits from machine to machine, and candidates of recognition with them: on aces 466 instead of 456.
#[test]
fn the_last_bits_of_a_pose_choose_no_other_points() {
    let exact = two_scans(0.0).thinned(0.05);
    for off in [1e-13, -1e-13, 3e-14, -3e-14] {
        let moved = two_scans(off).thinned(0.05);
        assert_eq!(moved.len(), exact.len(), "off by {off}");
        for (point, other) in exact.points.iter().zip(&moved.points) {
            assert!((point - other).norm() < 1e-11, "off by {off}: {point} became {other}");
        }
    }
}

#[test]
fn the_nearest_view_of_a_square_is_kept() {
    let seen_from = |x: f64| Cloud {
        points: vec![Vector2::new(0.001 * x, 0.0)],
        normals: vec![None],
        origins: vec![Vector2::new(x, 0.0)],
    };
    let mut cloud = seen_from(3.0);
    cloud.add(&seen_from(2.0), &SE2::new(0.0, 0.0, 0.0));
    cloud.add(&seen_from(5.0), &SE2::new(0.0, 0.0, 0.0));
    assert_eq!(cloud.thinned(0.05), seen_from(2.0));
}

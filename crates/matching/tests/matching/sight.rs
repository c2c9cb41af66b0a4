//! What a scan says about walls.

use nalgebra::Vector2;
use posecut_geometry::SE2;
use posecut_matching::{Cloud, Sight, sight};
use posecut_random::random;

use crate::rooms::{room, scan};

/// A wall along y at this x that faces the origin.
fn wall(x: f64) -> Cloud {
    let points: Vec<Vector2<f64>> = (-10..=10).map(|step| Vector2::new(x, 0.1 * f64::from(step))).collect();
    let count = points.len();
    Cloud {
        points,
        normals: vec![Some(Vector2::new(-1.0, 0.0)); count],
        origins: vec![Vector2::zeros(); count],
    }
}

#[test]
fn walls_are_seen_seen_through_or_hidden() {
    let here = SE2::new(0.0, 0.0, 0.0);
    // The room's wall is at x = 5 there.
    let scan = scan(&room(), &SE2::new(0.0, -1.5, 0.0), 0.0, &mut random(1, "scan"));
    let found = |x| sight(&wall(x), &scan, &here, 10.0, 0.3);
    assert_eq!(found(5.0), Sight { seen: 21, through: 0 });
    assert_eq!(found(3.0), Sight { seen: 0, through: 21 });
    assert_eq!(found(7.0), Sight { seen: 0, through: 0 });
    assert_eq!(sight(&wall(3.0), &scan, &here, 2.0, 0.3), Sight::default(), "beyond the range");
    let turned = SE2::new(0.0, 0.0, std::f64::consts::PI);
    assert_eq!(sight(&wall(3.0), &scan, &turned, 10.0, 0.3).share(), 0.0);
    let mut back = wall(3.0);
    back.normals.fill(Some(Vector2::new(1.0, 0.0)));
    assert_eq!(sight(&back, &scan, &here, 10.0, 0.3), Sight::default(), "the back of a wall");
    assert_eq!(found(5.0).and(found(3.0)).share(), 0.5);
}

#[test]
fn a_scan_sees_the_room_where_it_was_taken() {
    let mut random = random(2, "scan");
    let poses = [SE2::new(0.3, 0.2, 0.4), SE2::new(-2.0, -1.0, 2.0)];
    let scans = poses.map(|pose| scan(&room(), &pose, 0.01, &mut random));
    let map = Cloud::of_scan(&scans[0]);
    let right = posecut_geometry::LieGroup::between(&poses[0], &poses[1]);
    assert!(sight(&map, &scans[1], &right, 20.0, 0.3).share() > 0.97);
    let wrong = SE2::new(right.translation.x + 1.0, right.translation.y, right.angle() + 1.5);
    assert!(sight(&map, &scans[1], &wrong, 20.0, 0.3).share() < 0.8);
}

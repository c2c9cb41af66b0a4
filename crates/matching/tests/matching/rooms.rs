//! Rooms made of walls, and scans of them.

use nalgebra::Vector2;
use posecut_geometry::SE2;
use posecut_scan::{LaserScan, Wall, distance_to_wall};
use rand::Rng;
use rand_distr::{Distribution, Normal};

/// An L-shaped room with a pillar.
pub(crate) fn room() -> Vec<Wall> {
    let corners = [(-4.0, -3.0), (5.0, -3.0), (5.0, 1.0), (1.5, 1.0), (1.5, 4.0), (-4.0, 4.0)];
    let pillar = [(-1.5, 1.5), (-1.0, 1.5), (-1.0, 2.2), (-1.5, 2.2)];
    [closed(&corners), closed(&pillar)].concat()
}

/// A corridor along x, without ends that a scan could see.
pub(crate) fn corridor() -> Vec<Wall> {
    [-1.0, 1.2].map(|y| [Vector2::new(-500.0, y), Vector2::new(500.0, y)]).to_vec()
}

fn closed(corners: &[(f64, f64)]) -> Vec<Wall> {
    let point = |index: usize| {
        let (x, y) = corners[index % corners.len()];
        Vector2::new(x, y)
    };
    (0..corners.len()).map(|index| [point(index), point(index + 1)]).collect()
}

/// A scan with 360 beams all around, noise of this standard deviation and a reach of 30 m.
pub(crate) fn scan(walls: &[Wall], pose: &SE2, deviation: f64, random: &mut impl Rng) -> LaserScan {
    let noise = Normal::new(0.0, deviation).unwrap();
    let angle_step = std::f64::consts::TAU / 360.0;
    let mut scan =
        LaserScan { sensor: SE2::new(0.0, 0.0, 0.0), first_angle: -3.0, angle_step, ranges: Vec::new() };
    for beam in 0..360 {
        let direction = pose.rotation * nalgebra::UnitComplex::new(scan.angle(beam));
        let along = Vector2::new(direction.re, direction.im);
        let nearest = walls
            .iter()
            .filter_map(|wall| distance_to_wall(wall, &pose.translation, &along))
            .fold(30.0, f64::min);
        let range = if nearest < 30.0 { (nearest + noise.sample(random)).max(0.01) } else { 0.0 };
        scan.ranges.push(range);
    }
    scan
}

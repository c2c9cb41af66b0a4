//! Laser scanners: rays cast through the floor plan, written as NCLT's files.
//!
//! The ground is taken to be the plane on which the robot stands, and walls to be perpendicular to it. So there are no slopes in the scans,
//! and the scans of two keyframes differ by a motion in the plane.

use nalgebra::{Vector2, Vector3};
use posecut_geometry::{LieGroup, SE2};
use posecut_nclt_sensors::hokuyo::{ANGLE_STEP, BEAMS, FIRST_ANGLE, FORWARD, RANGES};
use posecut_nclt_sensors::velodyne::Hit;
use posecut_random::ChaCha8Rng;
use posecut_scan::distance_to_wall;
use rand::RngExt as _;

use crate::noise::normal;
use crate::world::{StandingWall, World};

/// Standard deviation of ranges, metres: that of the data sheets.
const NOISE: f64 = 0.02;
/// The share of beams that come back from nowhere.
const LOST: f64 = 0.005;

/// The origin of the body is assumed to be this high above the ground, metres. The dataset does not say it.
pub const ORIGIN: f64 = 0.3;
/// Height of the planar scanner above the ground, metres.
const HOKUYO_HEIGHT: f64 = ORIGIN + 0.44;
/// Height of the three-dimensional scanner above the ground, metres.
const VELODYNE_HEIGHT: f64 = ORIGIN + 0.957;

/// The lasers of an HDL-32E: the lowest one and the angle between neighbours, degrees.
const LOWEST_LASER: f64 = -30.67;
const LASER_STEP: f64 = 4.0 / 3.0;
const LASERS: u8 = 32;
/// Directions of a turn. The sensor has 2170; fewer keep the files small.
const DIRECTIONS: usize = 720;
/// The reach of the three-dimensional scanner, metres.
const REACH: f64 = 70.0;

/// The ranges of the planar scanner of a robot at a pose, 0 for a beam without a return. O(walls near + beams that they cover).
pub fn planar_scan(world: &World, robot: &SE2, draw: &mut ChaCha8Rng) -> Vec<f64> {
    let scanner = robot.compose(&SE2::new(FORWARD, 0.0, 0.0));
    let mut nearest = vec![RANGES.end; BEAMS];
    let walls = world.near(&scanner.translation, RANGES.end);
    let high = walls.into_iter().filter(|wall| wall.height > HOKUYO_HEIGHT);
    sweep(high, &scanner, [FIRST_ANGLE, ANGLE_STEP], BEAMS, |beam, distance, _| {
        nearest[beam] = f64::min(nearest[beam], distance);
    });
    let see = |distance: f64| {
        // Draw for every beam, so that a changed wall changes no other beam.
        let (error, lost) = (normal(draw, NOISE), draw.random_bool(LOST));
        if distance < RANGES.end && !lost { (distance + error).max(RANGES.start) } else { 0.0 }
    };
    nearest.into_iter().map(see).collect()
}

/// The hits of a turn of the three-dimensional scanner, in the frame of the body of a robot at a pose. O(walls near + directions * lasers).
pub fn spatial_scan(world: &World, robot: &SE2, draw: &mut ChaCha8Rng) -> Vec<Hit> {
    let step = std::f64::consts::TAU / DIRECTIONS as f64;
    let mut met: Vec<Vec<(f64, f64)>> = vec![Vec::new(); DIRECTIONS];
    let walls = world.near(&robot.translation, REACH);
    sweep(walls.into_iter(), robot, [0.0, step], DIRECTIONS, |beam, distance, wall| {
        met[beam].push((distance, wall.height));
    });
    let mut hits = Vec::new();
    for (direction, walls) in met.iter_mut().enumerate() {
        walls.sort_by(|one, other| one.0.total_cmp(&other.0));
        let (sine, cosine) = (step * direction as f64).sin_cos();
        for laser in 0..LASERS {
            let elevation = (LOWEST_LASER + LASER_STEP * f64::from(laser)).to_radians();
            let (error, lost) = (normal(draw, NOISE), draw.random_bool(LOST));
            let Some(distance) = first_met(walls, elevation.tan()).filter(|_| !lost) else { continue };
            // Along the ray, by the share of the error in the horizontal.
            let seen = distance + error * elevation.cos();
            if seen / elevation.cos() > REACH {
                continue;
            }
            let height = VELODYNE_HEIGHT + seen * elevation.tan();
            hits.push(Hit {
                point: Vector3::new(seen * cosine, -seen * sine, ORIGIN - height),
                intensity: 100,
                laser,
            });
        }
    }
    hits
}

/// The horizontal distance at which a ray with a slope first meets a wall or the ground. `walls` has distances and heights, the nearest
/// first.
fn first_met(walls: &[(f64, f64)], slope: f64) -> Option<f64> {
    let ground = if slope < 0.0 { VELODYNE_HEIGHT / -slope } else { f64::INFINITY };
    let wall = walls
        .iter()
        .map(|(distance, height)| (*distance, *height, VELODYNE_HEIGHT + slope * distance))
        .find(|(_, height, at)| at <= height)
        .map_or(f64::INFINITY, |(distance, ..)| distance);
    Some(ground.min(wall)).filter(|distance| distance.is_finite())
}

/// Calls `met` with beam and distance for each beam that meets a wall. Beams begin at `first` and are `step` apart, radians
/// anticlockwise seen from above; the y axis of the scanner's frame is to the right, as NCLT's.
fn sweep<'a>(
    walls: impl Iterator<Item = &'a StandingWall>,
    scanner: &SE2,
    [first, step]: [f64; 2],
    beams: usize,
    mut met: impl FnMut(usize, f64, &StandingWall),
) {
    use std::f64::consts::{PI, TAU};
    let inverse = scanner.inverse();
    for wall in walls {
        let ends = wall.ends.map(|end| {
            let here = inverse.translation + inverse.rotation * end;
            Vector2::new(here.x, -here.y)
        });
        let [one, other] = ends.map(|end| (end.y.atan2(end.x) - first).rem_euclid(TAU));
        // The wall covers the shorter arc between the directions of its ends.
        let (start, extent) = match (other - one).rem_euclid(TAU) {
            turn if turn <= PI => (one, turn),
            turn => (other, TAU - turn),
        };
        // The arc may go through the first beam.
        for start in [start, start - TAU] {
            let low = (start / step).ceil().max(0.0) as usize;
            let high = ((start + extent) / step).floor();
            if high < 0.0 {
                continue;
            }
            for beam in low..=(high as usize).min(beams - 1) {
                let (sine, cosine) = (first + step * beam as f64).sin_cos();
                let along = Vector2::new(cosine, sine);
                if let Some(distance) = distance_to_wall(&ends, &Vector2::zeros(), &along) {
                    met(beam, distance, wall);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use posecut_random::random;

    use super::*;

    /// A wall 5 m north of the origin, from west to east, 2 m high.
    fn world() -> World {
        let ends = [Vector2::new(5.0, -50.0), Vector2::new(5.0, 50.0)];
        World::of_walls(&[StandingWall { ends, height: 2.0 }])
    }

    #[test]
    fn beams_end_at_the_wall() {
        let mut draw = random(1, "test");
        // Looking north-east, the wall is to the left.
        let ranges = planar_scan(&world(), &SE2::new(0.0, 0.0, 0.5), &mut draw);
        for (beam, range) in ranges.iter().enumerate().filter(|(_, range)| **range > 0.0) {
            let north = FORWARD * 0.5_f64.cos();
            let angle = FIRST_ANGLE + ANGLE_STEP * beam as f64 - 0.5;
            assert!((north + range * angle.cos() - 5.0).abs() < 0.1, "beam {beam}: {range}");
        }
        let seen = ranges.iter().filter(|range| **range > 0.0).count();
        // 160 degrees are nearer than 30 m.
        assert!((580..660).contains(&seen), "{seen}");
    }

    #[test]
    fn hits_are_on_the_ground_or_on_the_wall() {
        let mut draw = random(1, "test");
        let hits = spatial_scan(&world(), &SE2::new(0.0, 0.0, -0.7), &mut draw);
        let robot = SE2::new(0.0, 0.0, -0.7);
        let (mut on_wall, mut on_ground) = (0, 0);
        for hit in &hits {
            let place = robot.rotation * hit.point.xy();
            if (hit.point.z - ORIGIN).abs() < 0.1 {
                assert!(place.x < 5.2 || place.y.abs() > 49.0, "behind the wall");
                on_ground += 1;
            } else {
                assert!((place.x - 5.0).abs() < 0.1 && hit.point.z > ORIGIN - 2.2, "{hit:?}");
                on_wall += 1;
            }
        }
        assert!(on_wall > 1000 && on_ground > 5000, "{on_wall} {on_ground}");
    }

    #[test]
    fn low_walls_hide_no_high_ones() {
        let walls = [(3.0, 0.5), (6.0, 4.0)];
        assert_eq!(first_met(&walls, 0.0), Some(6.0));
        assert_eq!(first_met(&walls, -0.3), Some(3.0));
        assert_eq!(first_met(&walls, -1.0), Some(VELODYNE_HEIGHT));
        assert_eq!(first_met(&walls, 1.0), None);
    }
}

//! Paths in the plane.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Vector2;
use posecut_geometry::{SE2, wrap_angle};
use posecut_random::{ChaCha8Rng, random};
use rand::RngExt as _;

use super::path_of;
use crate::noise::normal;
use crate::{Character, World};

/// Distance of two crossings, metres.
const BLOCK: i64 = 10;
/// Metres of path for each block of the streets: a place is visited a few times.
const PATH_OF_BLOCK: f64 = 100.0;
/// Poses on a square metre of the meadow.
const DENSITY: f64 = 0.15;
/// The share of a turn that the next step keeps on the meadow, and the deviation of what it adds, radians.
const TURN: (f64, f64) = (0.9, 0.05);
/// The turn of a robot that has left the meadow, radians.
const RETURN: f64 = 0.3;
/// Rounds of each robot.
const ROUNDS: f64 = 3.0;

/// The paths of all robots.
pub(super) fn walks(character: &Character, seed: u64, attempt: usize) -> Vec<Vec<SE2>> {
    let total = (character.robots * character.poses) as f64;
    let circuit = Circuit::draw(character.poses as f64 / ROUNDS, &mut random(seed, "circuit"));
    (0..character.robots)
        .map(|robot| {
            let mut random = path_of(robot, seed, attempt);
            match character.world {
                World::Streets => streets(character.poses, total, &mut random),
                World::Rounds => circuit.rounds(character.poses, &mut random),
                World::Meadow | World::Flight => meadow(character.poses, total, &mut random),
            }
        })
        .collect()
}

/// Metre by metre along the streets, with a turn of -1, 0 or 1 quarter at every crossing.
fn streets(poses: usize, total: f64, random: &mut ChaCha8Rng) -> Vec<SE2> {
    let blocks = ((total / PATH_OF_BLOCK).sqrt() as i64).max(2);
    let side = blocks * BLOCK;
    let ahead = |(x, y, quarter): (i64, i64, i64)| {
        let (along, across) = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarter.rem_euclid(4) as usize];
        (x + along, y + across)
    };
    let crossing = |random: &mut ChaCha8Rng| random.random_range(0..=blocks) * BLOCK;
    let mut now = (crossing(random), crossing(random), random.random_range(0..4_i64));
    let mut path = Vec::with_capacity(poses);
    for _ in 0..poses {
        if now.0 % BLOCK == 0 && now.1 % BLOCK == 0 {
            now.2 += random.random_range(-1..=1);
            let leaves = |quarter| {
                let (x, y) = ahead((now.0, now.1, quarter));
                !(0..=side).contains(&x) || !(0..=side).contains(&y)
            };
            while leaves(now.2) {
                now.2 += 1;
            }
        }
        path.push(SE2::new(now.0 as f64, now.1 as f64, wrap_angle(now.2 as f64 * FRAC_PI_2)));
        let (x, y) = ahead(now);
        now = (x, y, now.2);
    }
    path
}

/// Slow turns in a square, and back when the path leaves it.
fn meadow(poses: usize, total: f64, random: &mut ChaCha8Rng) -> Vec<SE2> {
    let half = (total / DENSITY).sqrt() / 2.0;
    let mut place = Vector2::new(random.random_range(-half..half), random.random_range(-half..half));
    let (mut heading, mut turn) = (random.random_range(-PI..PI), 0.0);
    let mut path = Vec::with_capacity(poses);
    for _ in 0..poses {
        path.push(SE2::new(place.x, place.y, wrap_angle(heading)));
        turn = TURN.0 * turn + TURN.1 * normal(random);
        if place.amax() > half {
            turn = wrap_angle((-place.y).atan2(-place.x) - heading).clamp(-RETURN, RETURN);
        }
        heading += turn;
        place += Vector2::new(heading.cos(), heading.sin());
    }
    path
}

/// A closed curve around the origin: `r(a) = radius (1 + sum_k height_k cos(k a + phase_k))`.
struct Circuit {
    radius: f64,
    waves: [(f64, f64, f64); 2],
}

impl Circuit {
    /// A circuit of about this length, metres.
    fn draw(length: f64, random: &mut ChaCha8Rng) -> Self {
        let mut phase = || random.random_range(0.0..TAU);
        Self { radius: length / TAU, waves: [(2.0, 0.25, phase()), (3.0, 0.15, phase())] }
    }

    /// The place at an angle, and its derivative.
    fn at(&self, angle: f64) -> (Vector2<f64>, Vector2<f64>) {
        let (mut radius, mut slope) = (1.0, 0.0);
        for &(number, height, phase) in &self.waves {
            radius += height * (number * angle + phase).cos();
            slope -= height * number * (number * angle + phase).sin();
        }
        let (outwards, onwards) =
            (Vector2::new(angle.cos(), angle.sin()), Vector2::new(-angle.sin(), angle.cos()));
        (outwards * (self.radius * radius), (outwards * slope + onwards * radius) * self.radius)
    }

    /// Rounds in one direction or the other, up to a metre beside the curve.
    fn rounds(&self, poses: usize, random: &mut ChaCha8Rng) -> Vec<SE2> {
        let direction = if random.random::<bool>() { 1.0 } else { -1.0 };
        let (mut angle, mut beside) = (random.random_range(0.0..TAU), 0.0);
        let mut path = Vec::with_capacity(poses);
        for _ in 0..poses {
            let (place, slope) = self.at(angle);
            let along = slope.normalize() * direction;
            beside = f64::clamp(beside + 0.05 * normal(random), -1.0, 1.0);
            let place = place + Vector2::new(-along.y, along.x) * beside;
            path.push(SE2::new(place.x, place.y, along.y.atan2(along.x)));
            angle += direction / slope.norm();
        }
        path
    }
}

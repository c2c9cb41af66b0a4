//! Flights in a ball.

use nalgebra::{Vector3, Vector6};
use posecut_geometry::{LieGroup as _, SE3};
use posecut_random::ChaCha8Rng;

use super::path_of;
use crate::Character;
use crate::noise::normal;

/// Poses in a cubic metre, so that each sees some others within the recogniser's reach.
const DENSITY: f64 = 0.05;
/// The share of a turn that the next step keeps, and the deviation of what it adds, radians.
const TURN: (f64, f64) = (0.8, 0.08);
/// The turn towards the middle of a robot that has left the ball, radians.
const RETURN: f64 = 0.3;

/// The paths of all robots.
pub(super) fn walks(character: &Character, seed: u64, attempt: usize) -> Vec<Vec<SE3>> {
    let volume = (character.robots * character.poses) as f64 / DENSITY;
    let radius = (volume / (4.0 / 3.0 * std::f64::consts::PI)).cbrt();
    (0..character.robots)
        .map(|robot| path(character.poses, radius, &mut path_of(robot, seed, attempt)))
        .collect()
}

fn path(poses: usize, radius: f64, random: &mut ChaCha8Rng) -> Vec<SE3> {
    let mut pose =
        SE3::exp(&Vector6::from_fn(|axis, _| normal(random) * if axis < 3 { 0.4 * radius } else { 1.0 }));
    let mut turn = Vector3::zeros();
    let mut path = Vec::with_capacity(poses);
    for _ in 0..poses {
        path.push(pose);
        turn = turn * TURN.0 + Vector3::from_fn(|_, _| normal(random)) * TURN.1;
        let mut turned = turn;
        if pose.translation.norm() > radius {
            // About the axis that turns the nose towards the middle on the shortest way.
            let inwards = pose.rotation.inverse() * -pose.translation.normalize();
            let axis = Vector3::x().cross(&inwards);
            turned = axis * (RETURN / axis.norm().max(0.1));
        }
        pose = pose.compose(&SE3::exp(&Vector6::new(1.0, 0.0, 0.0, turned.x, turned.y, turned.z)));
    }
    path
}

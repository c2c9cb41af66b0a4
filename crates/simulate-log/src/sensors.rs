//! Odometry and laser scanner.

use nalgebra::{UnitComplex, Vector2, Vector3};
use posecut_carmen::noise::slip_variances;
use posecut_geometry::{LieGroup, SE2};
use posecut_random::ChaCha8Rng;
use posecut_scan::{LaserScan, Wall, distance_to_wall};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// Beams of a scan, over 180 degrees, as those of the SICK LMS.
pub const BEAMS: usize = 180;

/// The scanner sees no farther, metres.
pub const REACH: f64 = 30.0;

/// The share of beams that come back from nowhere.
const LOST: f64 = 0.005;

/// A normally distributed number with mean 0 and variance 1.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// The poses that the odometry reports: the true motions with slips of the error model of [`posecut_carmen::noise`], times a factor.
/// O(poses).
pub fn odometry(poses: &[SE2], slip: f64, random: &mut ChaCha8Rng) -> Vec<SE2> {
    let mut at = SE2::identity();
    let mut reported = vec![at; poses.len().min(1)];
    for pair in poses.windows(2) {
        let motion = pair[0].between(&pair[1]);
        let deviations = slip_variances(&motion).map(f64::sqrt) * slip;
        let error = Vector3::from_fn(|row, _| deviations[row] * normal(random));
        at = at.compose(&motion).compose(&SE2::exp(&error));
        reported.push(at);
    }
    reported
}

/// What the scanner sees at a pose: ranges with noise of this standard deviation. O(beams * walls).
pub fn scan(walls: &[Wall], pose: &SE2, noise: f64, random: &mut ChaCha8Rng) -> LaserScan {
    let angle_step = std::f64::consts::PI / BEAMS as f64;
    let first_angle = -std::f64::consts::FRAC_PI_2;
    let mut scan =
        LaserScan { sensor: SE2::identity(), first_angle, angle_step, ranges: Vec::with_capacity(BEAMS) };
    for beam in 0..BEAMS {
        let direction = pose.rotation * UnitComplex::new(scan.angle(beam));
        let along = Vector2::new(direction.re, direction.im);
        let nearest = walls
            .iter()
            .filter_map(|wall| distance_to_wall(wall, &pose.translation, &along))
            .fold(REACH, f64::min);
        // Draw for every beam, so that a changed wall changes no other beam.
        let (error, lost) = (noise * normal(random), random.random_bool(LOST));
        let seen = nearest < REACH && !lost;
        scan.ranges.push(if seen { (nearest + error).max(0.02) } else { 0.0 });
    }
    scan
}

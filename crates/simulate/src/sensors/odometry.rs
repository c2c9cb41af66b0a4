//! NCLT's computed odometry: `odometry_mu_100hz.csv`, and `odometry_mu.csv` at the images.

use nalgebra::Vector3;
use posecut_geometry::{LieGroup, SE3};
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

use super::{Row, six};
use crate::drive::Instant;
use crate::noise::{Wander, normal};
use crate::session::time;

/// Standard deviations of a step of 0.2 s, from NCLT's odometry_cov.csv: x, y, z in metres, roll, pitch, yaw
/// in radians.
const STEP_SIGMA: [f64; 6] = [0.022, 0.0003, 0.0037, 0.0165, 0.0165, 0.000_66];
const STEP_SECONDS: f64 = 0.2;
/// The images' period, seconds.
const IMAGE_PERIOD: f64 = 0.2;
/// Gravity limits the error of roll and pitch: it does not accumulate.
const TILT: f64 = 0.01;
/// Number of times in a session that the wheels lose grip for some seconds.
const GROSS_SLIPS: f64 = 3.0;

/// The rows of the three files.
pub struct Odometry {
    /// `odometry_mu_100hz.csv`: poses from the start.
    pub integrated: Vec<Row>,
    /// `odometry_mu.csv`: poses relative to the previous image.
    pub relative: Vec<Row>,
    /// `odometry_cov.csv`: covariances of the relative poses, as NCLT states them.
    pub covariance: Vec<Row>,
}

/// Integrates the true motion with noise of NCLT's stated size, a scale error, a slowly varying turn error, and a few
/// gross slips, all as in real sessions.
pub fn odometry(drive: &[Instant], start: i64, period: f64, draw: &mut ChaCha8Rng) -> Odometry {
    // The standard deviation of independent errors grows with the square root of time.
    let share = (period / STEP_SECONDS).sqrt();
    let scale = 1.0 + normal(draw, 0.004);
    let mut turn = Wander::new(draw, 1.0e-4, 300.0);
    let (mut roll_error, mut pitch_error) = (Wander::new(draw, TILT, 5.0), Wander::new(draw, TILT, 5.0));
    let slip_chance = GROSS_SLIPS / drive.len() as f64;
    let mut slipping: Option<(f64, f64, f64)> = None;
    let (mut position, mut yaw) = (Vector3::zeros(), 0.0);
    let mut poses = vec![SE3::identity()];
    for pair in drive.windows(2) {
        let motion = pair[0].pose.between(&pair[1].pose);
        let (_, _, true_turn) = motion.euler();
        if draw.random_bool(slip_chance) {
            slipping = Some((3.0, normal(draw, 0.5), normal(draw, 0.03)));
        }
        let (mut forward_slip, mut turn_slip) = (0.0, 0.0);
        if let Some((left, forward, turn)) = &mut slipping {
            (forward_slip, turn_slip) = (*forward * period, *turn * period);
            *left -= period;
            if *left <= 0.0 {
                slipping = None;
            }
        }
        let moving = if pair[1].speed > 0.02 { 1.0 } else { 0.0 };
        let mut noise = |axis: usize| moving * normal(draw, STEP_SIGMA[axis] * share);
        let step = Vector3::new(
            scale * motion.translation.x + noise(0) + forward_slip,
            motion.translation.y + noise(1),
            motion.translation.z + noise(2),
        );
        let yaw_noise = noise(5);
        let (roll, pitch, _) = pair[0].pose.euler();
        let tilted = SE3::from_euler(
            0.0,
            0.0,
            0.0,
            roll + roll_error.step(draw, period),
            pitch + pitch_error.step(draw, period),
            yaw,
        );
        position += tilted.rotation * step;
        yaw += true_turn + moving * turn.step(draw, period) * period + yaw_noise + turn_slip;
        let (roll, pitch, _) = pair[1].pose.euler();
        poses.push(SE3::from_euler(position.x, position.y, position.z, roll, pitch, yaw));
    }
    let times: Vec<i64> = drive.iter().map(|instant| time(start, instant.seconds)).collect();
    let integrated = times.iter().zip(&poses).map(|(&time, pose)| (time, six(pose))).collect();
    let every = ((IMAGE_PERIOD / period).round() as usize).max(1);
    let images: Vec<usize> = (0..poses.len()).step_by(every).collect();
    let mut relative = vec![(times[0], vec![0.0; 6])];
    relative.extend(
        images.windows(2).map(|pair| (times[pair[1]], six(&poses[pair[0]].between(&poses[pair[1]])))),
    );
    let covariance = relative.iter().map(|(time, _)| (*time, stated_covariance())).collect();
    Odometry { integrated, relative, covariance }
}

/// The upper triangle of the covariance that NCLT states for a step.
fn stated_covariance() -> Vec<f64> {
    (0..6)
        .flat_map(|row| (row..6).map(move |column| if row == column { STEP_SIGMA[row].powi(2) } else { 0.0 }))
        .collect()
}

//! The error model of wheel odometry.
//!
//! A small motion over a distance `d` (metres) with a turn `a` (radians) has independent normal errors along the axes of the robot after it,
//! with the variances
//!
//! ```text
//! s_d d + s_a |a|
//! ```
//!
//! and constants for forward, sideways and heading (Thrun, Burgard, Fox, *Probabilistic Robotics*, 2005, section 5.4, has the same
//! causes). The errors of a step between keyframes are those of its small motions, carried to its end by the adjoint (first order):
//! `S <- Ad(m)^-1 S Ad(m)^-T + diag(s_d d + s_a |a|)`. So an error of heading moves what comes after it sideways, two half steps are as
//! certain as one whole step, and the distance of keyframes does not matter. In addition, a step of any size has a minimum variance.
//!
//! The constants are the mean over three logs (aces, intel, mit-csail of the radish collection) of the squared differences between
//! odometry and ICP, over steps of 0.5 m or 0.5 rad: straight ones for `s_d`, turns on the spot for `s_a`; sideways less than
//! that, by what the heading contributes. The logs differ by factors of up to 4 in a standard deviation; the README has the figures.

use nalgebra::{Matrix3, Vector3};
use posecut_geometry::SE2;
use posecut_matching::laser_odometry::Measured;

use crate::keyframes::Step;

/// Standard deviations that a step of any size has: forward, sideways, heading, in metres and radians.
const LEAST: [f64; 3] = [0.005, 0.005, 0.002];
/// Variances for each metre, m^2/m and rad^2/m.
const DISTANCE: [f64; 3] = [0.004, 0.0004, 0.003];
/// Variances for each radian, m^2/rad and rad^2/rad. The wheels turn about a point that is not quite the origin: sideways.
const TURNING: [f64; 3] = [0.0005, 0.003, 0.012];

/// The variances of the errors of a small motion, along x, y and theta after it, m^2 and rad^2.
pub fn slip_variances(motion: &SE2) -> Vector3<f64> {
    let (distance, turning) = (motion.translation.norm(), motion.angle().abs());
    Vector3::from_fn(|row, _| DISTANCE[row] * distance + TURNING[row] * turning)
}

/// A step as the odometry measures it.
pub fn measured(step: &Step) -> Measured {
    Measured { motion: step.motion, information: information(step) }
}

/// The information matrix of a step, order x, y, theta.
fn information(step: &Step) -> Matrix3<f64> {
    let least = Vector3::from(LEAST).map(|deviation| deviation * deviation);
    let covariance = step.slip + Matrix3::from_diagonal(&least);
    // Positive definite, because the least variances are.
    covariance.cholesky().map_or_else(Matrix3::zeros, |factor| factor.inverse())
}

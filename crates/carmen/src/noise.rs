//! The error model of wheel odometry.
//!
//! Over a path of length `d` (metres) with turns of `a` radians altogether, the errors along the axes of the later keyframe are
//! independent and normal with the variances
//!
//! ```text
//! s_0^2 + s_d d + s_a a
//! ```
//!
//! with constants for forward, sideways and heading. Variances are linear in the path, as of a sum of independent slips (Thrun,
//! Burgard, Fox, *Probabilistic Robotics*, 2005, section 5.4, has the same causes). So two half steps are as certain as one whole
//! step, and the distance of keyframes does not matter.
//!
//! The constants are the mean over three logs (aces, intel, mit-csail of the radish collection) of the squared differences between
//! odometry and ICP, over steps of 0.5 m or 0.5 rad: straight ones for `s_d`, turns on the spot for `s_a`. The logs differ by factors
//! of up to 4 in a standard deviation; the README has the figures.

use nalgebra::{Matrix3, Vector3};

use crate::keyframes::Step;

/// Standard deviations that a step of any size has: forward, sideways, heading, in metres and radians.
const LEAST: [f64; 3] = [0.005, 0.005, 0.002];
/// Variances for each metre, m^2/m and rad^2/m.
const DISTANCE: [f64; 3] = [0.004, 0.0006, 0.003];
/// Variances for each radian, m^2/rad and rad^2/rad. The wheels turn about a point that is not quite the origin: sideways.
const TURNING: [f64; 3] = [0.0005, 0.003, 0.012];

/// The variances of the slips of a step, without what a step of any size has, along x, y and theta in its last frame, m^2 and rad^2.
pub fn slip_variances(step: &Step) -> Vector3<f64> {
    Vector3::from_fn(|row, _| DISTANCE[row] * step.distance + TURNING[row] * step.turning)
}

/// The variances of a step along x, y and theta in its last frame, m^2 and rad^2.
pub fn variances(step: &Step) -> Vector3<f64> {
    slip_variances(step) + Vector3::from_fn(|row, _| LEAST[row] * LEAST[row])
}

/// The information matrix of a step, order x, y, theta.
pub fn information(step: &Step) -> Matrix3<f64> {
    Matrix3::from_diagonal(&variances(step).map(f64::recip))
}

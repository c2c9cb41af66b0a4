//! Angles of the plane.

use std::f64::consts::{PI, TAU};

/// Brings an angle into `(-pi, pi]`, in radians.
///
/// Angles that are already in this range keep their bits. The error is that of the argument: an angle of many turns has lost
/// as many digits before the call. NaN and infinity give NaN.
///
/// ```
/// use posecut_geometry::wrap_angle;
/// use std::f64::consts::PI;
///
/// assert_eq!(wrap_angle(-PI), PI);
/// assert_eq!(wrap_angle(0.25), 0.25);
/// assert!((wrap_angle(7.0) - (7.0 - 2.0 * PI)).abs() < 1e-15);
/// ```
#[inline]
pub fn wrap_angle(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let remainder = angle % TAU;
    if remainder > PI {
        remainder - TAU
    } else if remainder <= -PI {
        remainder + TAU
    } else {
        remainder
    }
}

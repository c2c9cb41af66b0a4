//! Headings: `ms25_euler.csv` from the IMU's magnetometer, `kvh.csv` from the fibre-optic gyro.

use posecut_geometry::wrap_angle;
use posecut_random::ChaCha8Rng;

use super::Row;
use crate::campus::Campus;
use crate::drive::Instant;
use crate::noise::{Wander, normal};
use crate::session::time;

/// Roll, pitch and a heading. Iron near the path disturbs the heading by tenths of a radian, in some places by more.
pub fn euler(campus: &Campus, drive: &[Instant], start: i64, period: f64, draw: &mut ChaCha8Rng) -> Vec<Row> {
    let mut filter = Wander::new(draw, 0.03, 30.0);
    drive
        .iter()
        .map(|instant| {
            let (roll, pitch, yaw) = instant.pose.euler();
            let bend = campus.compass_error(&instant.pose.translation.xy());
            let heading = wrap_angle(yaw + bend + filter.step(draw, period));
            (
                time(start, instant.seconds),
                vec![roll + normal(draw, 0.008), pitch + normal(draw, 0.008), heading],
            )
        })
        .collect()
}

/// The integrated rate of the fibre-optic gyro, from an arbitrary start, in [0, 2 pi). It drifts by some degrees an
/// hour.
pub fn fibre_optic_gyro(drive: &[Instant], start: i64, period: f64, draw: &mut ChaCha8Rng) -> Vec<Row> {
    let bias = normal(draw, 1.0e-5);
    let mut error = normal(draw, 1.0);
    drive
        .iter()
        .map(|instant| {
            error += bias * period + normal(draw, 2.0e-4 * period.sqrt());
            let heading = (instant.pose.to_planar().angle() + error).rem_euclid(std::f64::consts::TAU);
            (time(start, instant.seconds), vec![heading])
        })
        .collect()
}

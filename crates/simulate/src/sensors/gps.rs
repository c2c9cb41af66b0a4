//! `gps.csv`: consumer GPS.

use posecut_geometry::geodetic;
use posecut_random::ChaCha8Rng;

use super::Row;
use crate::drive::Instant;
use crate::noise::{Wander, normal};
use crate::session::time;

/// Rows of mode, satellites, latitude, longitude (rad), altitude, track, speed, at most five a second, in NCLT's local frame. The error varies
/// by metres. Between buildings the receiver loses its fix, and the rows have mode 0.
pub fn gps(drive: &[Instant], start: i64, period: f64, draw: &mut ChaCha8Rng) -> Vec<Row> {
    let every = ((0.2 / period).round() as usize).max(1);
    let step = every as f64 * period;
    let (mut north, mut east) = (Wander::new(draw, 2.5, 120.0), Wander::new(draw, 2.5, 120.0));
    let mut sky = Wander::new(draw, 1.0, 90.0);
    drive
        .iter()
        .step_by(every)
        .map(|instant| {
            let place = instant.pose.translation;
            let blocked = sky.step(draw, step) < -1.6;
            let x = place.x + north.step(draw, step);
            let y = place.y + east.step(draw, step);
            let [latitude, longitude, altitude] = geodetic::from_local([x, y, place.z]);
            let altitude = altitude + normal(draw, 4.0);
            let (mode, satellites) = if blocked { (0.0, 2.0) } else { (3.0, 8.0) };
            let track = instant.pose.to_planar().angle().rem_euclid(std::f64::consts::TAU);
            (
                time(start, instant.seconds),
                vec![mode, satellites, latitude, longitude, altitude, track, instant.speed],
            )
        })
        .collect()
}

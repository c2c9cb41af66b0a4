//! `wheels.csv`: speed of the left and of the right wheel.

use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

use super::Row;
use crate::drive::Instant;
use crate::noise::{Wander, normal};
use crate::session::time;

/// Metres between the wheels.
const TRACK: f64 = 0.56;
/// The encoder's smallest step, m/s.
const RESOLUTION: f64 = 0.006;

/// The wheels over-read by 6 to 8 %, depending on the session, and slip now and then.
pub fn wheels(drive: &[Instant], start: i64, period: f64, draw: &mut ChaCha8Rng) -> Vec<Row> {
    let over_read = draw.random_range(1.06..1.09);
    let mut slip = Wander::new(draw, 0.02, 20.0);
    drive
        .iter()
        .map(|instant| {
            let speed = over_read * instant.speed * (1.0 + slip.step(draw, period));
            let turn = 0.5 * TRACK * instant.yaw_rate;
            let mut read = |speed: f64| ((speed + normal(draw, 0.015)) / RESOLUTION).round() * RESOLUTION;
            let (left, right) = (read(speed + turn), read(speed - turn));
            (time(start, instant.seconds), vec![left, right])
        })
        .collect()
}

//! `ms25.csv`: magnetometer, accelerations and angular rates of the IMU.

use nalgebra::Vector3;
use posecut_random::ChaCha8Rng;

use super::Row;
use crate::campus::Campus;
use crate::drive::Instant;
use crate::noise::{Wander, normal};
use crate::session::time;

/// The magnetic field at Ann Arbor's latitude: 0.18 Gauss north, 0.50 Gauss down.
const FIELD: [f64; 3] = [0.18, 0.0, 0.50];
const GRAVITY: f64 = 9.805;

/// Rows of mag xyz (Gauss), accel xyz (m/s^2), rates roll pitch yaw (rad/s). The gyro's bias varies.
pub fn imu(campus: &Campus, drive: &[Instant], start: i64, period: f64, draw: &mut ChaCha8Rng) -> Vec<Row> {
    let mut bias = Wander::new(draw, 0.000_5, 600.0);
    let mut last_speed = 0.0;
    drive
        .iter()
        .map(|instant| {
            let attitude = instant.pose.rotation;
            let bend = campus.compass_error(&instant.pose.translation.xy());
            let north = Vector3::new(FIELD[0] * bend.cos(), -FIELD[0] * bend.sin(), FIELD[2]);
            let field = attitude.inverse() * north;
            let forward = (instant.speed - last_speed) / period;
            last_speed = instant.speed;
            let down = attitude.inverse() * Vector3::new(0.0, 0.0, -GRAVITY);
            let acceleration = down + Vector3::new(forward, instant.speed * instant.yaw_rate, 0.0);
            let mut row = Vec::with_capacity(9);
            row.extend(field.iter().map(|value| value + normal(draw, 0.002)));
            row.extend(acceleration.iter().map(|value| value + normal(draw, 0.15)));
            row.extend([normal(draw, 0.02), normal(draw, 0.02)]);
            row.push(instant.yaw_rate + bias.step(draw, period) + normal(draw, 0.01));
            (time(start, instant.seconds), row)
        })
        .collect()
}

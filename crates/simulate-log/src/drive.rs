//! The pose at every scan: the robot turns on the spot at corners and drives straight between them.

use nalgebra::Vector2;
use posecut_geometry::{SE2, wrap_angle};

/// Speed, m/s.
const SPEED: f64 = 0.6;
/// Rate of turning, rad/s.
const TURNING: f64 = 0.8;
/// Time between scans, microseconds: 5 Hz.
pub const PERIOD: i64 = 200_000;

/// The poses along a way until it ends or this length is driven, one a period. O(length).
pub fn drive(way: &[Vector2<f64>], length: f64) -> Vec<SE2> {
    let seconds = PERIOD as f64 * 1e-6;
    let mut poses = Vec::new();
    let mut heading: Option<f64> = None;
    let mut left = length;
    for pair in way.windows(2) {
        let along = pair[1] - pair[0];
        let distance = along.norm().min(left);
        if distance <= 0.0 {
            continue;
        }
        let direction = along.y.atan2(along.x);
        let from = heading.replace(direction).unwrap_or(direction);
        let turn = wrap_angle(direction - from);
        let steps = (turn.abs() / (TURNING * seconds)).ceil();
        for step in 0..steps as usize {
            poses.push(SE2::new(pair[0].x, pair[0].y, from + turn * step as f64 / steps));
        }
        let steps = (distance / (SPEED * seconds)).ceil();
        for step in 0..steps as usize {
            let point = pair[0] + along.normalize() * (distance * step as f64 / steps);
            poses.push(SE2::new(point.x, point.y, direction));
        }
        left -= distance;
        if left <= 0.0 {
            break;
        }
    }
    poses
}

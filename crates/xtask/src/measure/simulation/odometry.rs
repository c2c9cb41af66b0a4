//! Dead reckoning, and step errors and drift of an odometry.

use super::Statistics;
use super::plane::{Pose, align, between, distance, exp, robust_deviation, wrap};
use super::series::{Series, grid};
use super::session::KEYFRAME_SECONDS;

const START_METRES: f64 = 200.0;

/// Positions from the wheels' mean speed along the IMU's heading, as in posecut-ingest --odometry wheels.
pub(super) fn dead_reckoning(wheels: &Series<2>, euler: &Series<2>) -> Option<Series<3>> {
    let (mut rows, mut x, mut y) = (Vec::new(), 0.0, 0.0);
    // Time, speed and heading.
    let mut last: Option<(f64, f64, f64)> = None;
    for (&time, [left, right]) in wheels.times.iter().zip(&wheels.rows) {
        let Some([pitch, heading]) = euler.at(time) else { continue };
        let speed = 0.5 * (left + right) * pitch.cos();
        if let Some((time_before, speed_before, heading_before)) = last {
            let way = 0.5 * (speed + speed_before) * (time - time_before);
            let middle = heading_before + 0.5 * wrap(heading - heading_before);
            (x, y) = (x + way * middle.cos(), y + way * middle.sin());
        }
        last = Some((time, speed, heading));
        rows.push((time, [x, y, heading]));
    }
    Series::new(rows, Some(2))
}

/// Step errors and drift of one odometry.
pub(super) fn statistics(prefix: &str, odometry: &Series<3>, truth: &Series<3>) -> Statistics {
    let (first, last) = (odometry.first().max(truth.first()), odometry.last().min(truth.last()));
    let pairs: Vec<Option<(Pose, Pose)>> =
        grid(first, last, KEYFRAME_SECONDS).map(|time| Some((odometry.at(time)?, truth.at(time)?))).collect();
    let error = |pair: &[Option<(Pose, Pose)>]| {
        let ((measured, true_pose), (measured_next, true_next)) = (pair[0]?, pair[1]?);
        Some(between(exp(between(measured, measured_next)), exp(between(true_pose, true_next))))
    };
    let errors: Vec<Pose> = pairs.windows(2).filter_map(error).collect();
    let (measured, true_poses): (Vec<Pose>, Vec<Pose>) = pairs.into_iter().flatten().unzip();
    let (mut driven, mut start) = (0.0, 1);
    while start < true_poses.len() && driven < START_METRES {
        driven += distance(true_poses[start - 1], true_poses[start]);
        start += 1;
    }
    let (by_start, by_all) = (align(&measured[..start], &true_poses[..start]), align(&measured, &true_poses));
    let squares =
        measured.iter().zip(&true_poses).map(|(p, q)| distance(by_all(*p), *q).powi(2)).sum::<f64>();
    let end = measured.len() - 1;
    let step = |axis: usize| robust_deviation(errors.iter().map(|error| error[axis]));
    let drift = distance(by_start(measured[end]), true_poses[end]);
    [
        ("step error forward (m)", format!("{:.3}", step(0))),
        ("step error sideways (m)", format!("{:.3}", step(1))),
        ("step error heading (rad)", format!("{:.4}", step(2))),
        ("end drift, start aligned (m)", format!("{drift:.1}")),
        ("ATE, all aligned (m)", format!("{:.1}", (squares / measured.len() as f64).sqrt())),
    ]
    .map(|(name, value)| (format!("{prefix}: {name}"), value))
    .to_vec()
}

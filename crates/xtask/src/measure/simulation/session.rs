//! The statistics of one session.

use std::path::Path;

use anyhow::bail;

use super::Statistics;
use super::odometry::{self, dead_reckoning};
use super::plane::{Pose, distance, landmark_edges, path_length, quantile, turning, wrap};
use super::series::{Series, grid, read};

/// Seconds between keyframes, as in the paper.
pub(super) const KEYFRAME_SECONDS: f64 = 2.0;
/// Seconds between the points whose distances add up to the length.
const LENGTH_SECONDS: f64 = 1.0;
/// The robot moves if it is at least this fast, m/s.
const MOVING: f64 = 0.15;

/// The statistics of a session in the order of rows; `None` without ground truth.
pub(super) fn statistics(directory: &Path, name: &str) -> anyhow::Result<Option<Statistics>> {
    let path = |file: &str| directory.join(file);
    let Some(truth) = read(&path(&format!("groundtruth_{name}.csv")), [1, 2, 6], Some(2))? else {
        return Ok(None);
    };
    let integrated = read(&path("odometry_mu_100hz.csv"), [1, 2, 6], Some(2))?;
    let wheels = read(&path("wheels.csv"), [1, 2], None)?;
    let euler = read(&path("ms25_euler.csv"), [2, 3], Some(1))?;
    let reckoned =
        wheels.as_ref().zip(euler.as_ref()).and_then(|(wheels, euler)| dead_reckoning(wheels, euler));

    let clock = integrated.as_ref().or(reckoned.as_ref()).unwrap_or(&truth);
    let (mut found, length) = driving(directory, &truth, clock.first(), clock.last())?;
    if let Some(integrated) = &integrated {
        found.extend(odometry::statistics("odometry_mu_100hz", integrated, &truth));
    }
    if let Some(reckoned) = &reckoned {
        found.extend(odometry::statistics("wheels + ms25_euler", reckoned, &truth));
    }
    if let Some(wheels) = &wheels {
        let way = |(seconds, [left, right], [next_left, next_right]): (f64, [f64; 2], [f64; 2])| {
            (0.25 * (left + right + next_left + next_right)).abs() * seconds
        };
        let ways: f64 = wheels.steps().map(way).sum();
        found.push(("wheels' path / true path".to_owned(), format!("{:.3}", ways / length)));
    }
    if let Some(euler) = &euler {
        found.extend(heading_errors(euler, &truth));
    }
    Ok(Some(found))
}

/// The statistics of the drive, and the length of its path in metres.
fn driving(directory: &Path, truth: &Series<3>, first: f64, last: f64) -> anyhow::Result<(Statistics, f64)> {
    let fine: Vec<Pose> = grid(first, last, LENGTH_SECONDS).filter_map(|time| truth.at(time)).collect();
    let keyframes: Vec<Option<Pose>> =
        grid(first, last, KEYFRAME_SECONDS).map(|time| truth.at(time)).collect();
    let speed = |pair: &[Option<Pose>]| Some(distance(pair[0]?, pair[1]?) / KEYFRAME_SECONDS);
    let speeds: Vec<f64> = keyframes.windows(2).filter_map(speed).collect();
    let moving: Vec<f64> = speeds.iter().copied().filter(|speed| *speed >= MOVING).collect();
    if moving.is_empty() {
        bail!("{}: the robot never moves", directory.display());
    }
    let length = path_length(&fine);
    let extent = |axis: usize| {
        let of = fine.iter().map(|pose| pose[axis]);
        of.clone().fold(f64::NEG_INFINITY, f64::max) - of.fold(f64::INFINITY, f64::min)
    };
    let rate = (truth.times.len() - 1) as f64 / (truth.last() - truth.first());
    let stopped = 100.0 * (1.0 - moving.len() as f64 / speeds.len() as f64);
    let found = [
        ("rows of ground truth a second", format!("{rate:.1}")),
        ("path length (m)", format!("{length:.0}")),
        ("duration (min)", format!("{:.1}", (last - first) / 60.0)),
        ("mean speed while moving (m/s)", format!("{:.2}", moving.iter().sum::<f64>() / moving.len() as f64)),
        ("median speed while moving (m/s)", format!("{:.2}", quantile(&moving, 0.5))),
        ("share of time stopped (%)", format!("{stopped:.1}")),
        ("turning (full turns)", format!("{:.0}", turning(&fine))),
        ("extent north x east (m)", format!("{:.0} x {:.0}", extent(0), extent(1))),
        ("correct landmark edges", landmark_edges(&keyframes).to_string()),
    ];
    Ok((found.map(|(name, value)| (name.to_owned(), value)).to_vec(), length))
}

/// The errors of the IMU's heading against the truth, in degrees.
fn heading_errors(euler: &Series<2>, truth: &Series<3>) -> Statistics {
    let error =
        |(time, [_, heading]): (&f64, &[f64; 2])| Some(wrap(heading - truth.at(*time)?[2]).to_degrees());
    let errors: Vec<f64> = euler.times.iter().zip(&euler.rows).filter_map(error).collect();
    let offset = quantile(&errors, 0.5);
    let rest: Vec<f64> =
        errors.iter().map(|error| ((error - offset + 180.0).rem_euclid(360.0) - 180.0).abs()).collect();
    let absolute: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    let signed = format!("{offset:.1}");
    let signed = if signed == "-0.0" { "0.0".to_owned() } else { signed };
    [
        ("absolute, median (deg)", format!("{:.1}", quantile(&absolute, 0.5))),
        ("absolute, 95 % (deg)", format!("{:.1}", quantile(&absolute, 0.95))),
        ("signed median (deg)", signed),
        ("median about that (deg)", format!("{:.1}", quantile(&rest, 0.5))),
    ]
    .map(|(name, value)| (format!("ms25_euler heading error: {name}"), value))
    .to_vec()
}

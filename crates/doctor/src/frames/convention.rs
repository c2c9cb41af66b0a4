//! Compares the odometry with the given poses.

use posecut_geometry::{LieGroup as _, SE3};

use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Survey, length, median};
use crate::words::figure;

/// Fewer steps prove nothing.
const FEWEST: usize = 5;
/// Steps that differ from those of the poses by this factor are in other units.
const FACTOR: f64 = 5.0;
/// Turns below this are noise, degrees.
const LEAST_TURN: f64 = 0.05;
/// Residuals of inverted measurements that are smaller by this factor prove the other direction.
const BETTER: f64 = 0.2;

pub(super) fn check(survey: &Survey<'_>) -> Vec<Finding> {
    let dimension = survey.graph.header.dimension;
    let pose = |node: usize| dimension.spatial(survey.graph.nodes[node].pose.as_deref()?);
    let steps: Vec<(SE3, SE3)> = survey
        .odometry
        .iter()
        .filter_map(|edge| Some((edge.motion?, pose(edge.ends.0)?.between(&pose(edge.ends.1)?))))
        .collect();
    if steps.len() < FEWEST {
        return Vec::new();
    }
    [inverted(&steps), units(&steps)].into_iter().flatten().collect()
}

/// Measurements that fit the poses from `to` to `from`.
fn inverted(steps: &[(SE3, SE3)]) -> Option<Finding> {
    let residual = |invert: bool| {
        median(steps.iter().map(|(measured, given)| {
            let measured = if invert { measured.inverse() } else { *measured };
            length(&measured.between(given))
        }))
    };
    let step = median(steps.iter().map(|(measured, _)| length(measured)))?;
    let (forward, backward) = (residual(false)?, residual(true)?);
    (forward > step && backward < BETTER * forward).then(|| {
        let title = format!(
            "odometry differs from the given poses by {} m a step, but its inverse by {} m (medians)",
            figure(forward),
            figure(backward)
        );
        Finding::new(Severity::Error, Topic::Frames, "inverted-measurements", title)
            .with("residual", forward)
            .with("residual_inverted", backward)
            .therefore(
                "the measurements are probably poses of `from` in the frame of `to`; the format wants `to` in the frame of `from`",
                "invert the measurements where the file is written, or exchange the ends of the edges",
            )
    })
}

/// Lengths and turns in other units than those of the poses.
fn units(steps: &[(SE3, SE3)]) -> Option<Finding> {
    let typical = |of: fn(&SE3) -> f64, least: f64| {
        let both: Vec<(f64, f64)> = steps.iter().map(|(measured, given)| (of(measured), of(given))).collect();
        let one = median(both.iter().map(|pair| pair.0)).filter(|value| *value > least)?;
        let other = median(both.iter().map(|pair| pair.1)).filter(|value| *value > least)?;
        Some((one, other, one / other))
    };
    let off = |ratio: f64| !(1.0 / FACTOR..=FACTOR).contains(&ratio);
    let lengths = typical(length, 0.0).filter(|found| off(found.2));
    let turns =
        typical(|motion| motion.rotation_angle().to_degrees(), LEAST_TURN).filter(|found| off(found.2));
    let (what, unit, (measured, given, ratio), remedy) = match (lengths, turns) {
        (Some(found), _) => (
            "moves",
            "m",
            found,
            "write measurements and poses in metres; if the poses are optimised with wrong landmark edges, or are placeholders, ignore this",
        ),
        (_, Some(found)) => (
            "turns by",
            "degrees",
            found,
            "write angles of measurements and poses in radians; if the poses are optimised with wrong landmark edges, or are placeholders, ignore this",
        ),
        _ => return None,
    };
    let title = format!(
        "an odometry step {what} {} {unit}, but {} {unit} by the given poses (medians)",
        figure(measured),
        figure(given)
    );
    let found = Finding::new(Severity::Warning, Topic::Frames, "pose-units", title)
        .with("measured", measured)
        .with("given", given)
        .with("ratio", ratio);
    Some(found.therefore(
        "measurements and poses have different units, or the poses are not of this odometry",
        remedy,
    ))
}

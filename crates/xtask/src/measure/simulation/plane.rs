//! Motions of the plane, quantiles, and statistics along a path.

use std::collections::HashMap;
use std::f64::consts::TAU;

/// A pose: x north, y east, heading.
pub(super) type Pose = [f64; 3];

const TURNING_METRES: f64 = 5.0;
const RADIUS: f64 = 3.0;
const HEADING: f64 = 30.0 * TAU / 360.0;

/// An angle from -pi to pi.
pub(super) fn wrap(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round_ties_even()
}

pub(super) fn distance(one: Pose, other: Pose) -> f64 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

/// The pose of `other` in the frame of `one`, as an SE(2) logarithm.
pub(super) fn between(one: Pose, other: Pose) -> Pose {
    let (sine, cosine) = one[2].sin_cos();
    let (x, y) = (other[0] - one[0], other[1] - one[1]);
    log([cosine * x + sine * y, cosine * y - sine * x, wrap(other[2] - one[2])])
}

fn log([x, y, angle]: Pose) -> Pose {
    let half = 0.5 * angle;
    // The quotient is 0 / 0 at 0: near it, use the first terms of the series.
    let factor = if half.abs() < 1e-6 { 1.0 - half * half / 3.0 } else { half / half.tan() };
    [factor * x + half * y, factor * y - half * x, angle]
}

pub(super) fn exp([u, v, angle]: Pose) -> Pose {
    // Both quotients are 0 / 0 at 0: near it, use the first terms of the series.
    let (sine, cosine) = if angle.abs() < 1e-6 {
        (1.0 - angle * angle / 6.0, 0.5 * angle)
    } else {
        (angle.sin() / angle, (1.0 - angle.cos()) / angle)
    };
    [sine * u - cosine * v, cosine * u + sine * v, angle]
}

/// The rigid planar motion that brings `moving` closest to `fixed` (Umeyama 1991, without scale).
pub(super) fn align(moving: &[Pose], fixed: &[Pose]) -> impl Fn(Pose) -> Pose + use<> {
    let mean = |points: &[Pose], axis: usize| {
        points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64
    };
    let from = [mean(moving, 0), mean(moving, 1)];
    let to = [mean(fixed, 0), mean(fixed, 1)];
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (p, q) in moving.iter().zip(fixed) {
        let (px, py, qx, qy) = (p[0] - from[0], p[1] - from[1], q[0] - to[0], q[1] - to[1]);
        cosine += px * qx + py * qy;
        sine += px * qy - py * qx;
    }
    let (sine, cosine) = sine.atan2(cosine).sin_cos();
    let shift = [to[0] - cosine * from[0] + sine * from[1], to[1] - sine * from[0] - cosine * from[1]];
    move |p| [cosine * p[0] - sine * p[1] + shift[0], sine * p[0] + cosine * p[1] + shift[1], p[2]]
}

/// The quantile: a share of the values is below it. Interpolates between two values.
pub(super) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut ordered = values.to_vec();
    ordered.sort_by(f64::total_cmp);
    let Some(last) = ordered.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let low = place as usize;
    ordered[low] + (place - low as f64) * (ordered[(low + 1).min(last)] - ordered[low])
}

/// The robust standard deviation.
pub(super) fn robust_deviation(values: impl Iterator<Item = f64>) -> f64 {
    1.4826 * quantile(&values.map(f64::abs).collect::<Vec<_>>(), 0.5)
}

pub(super) fn path_length(points: &[Pose]) -> f64 {
    points.windows(2).map(|pair| distance(pair[0], pair[1])).sum()
}

/// Sum of the absolute changes of direction between points that are some metres apart, in full turns.
pub(super) fn turning(points: &[Pose]) -> f64 {
    let mut corners: Vec<Pose> = points.iter().take(1).copied().collect();
    for point in points {
        if corners.last().is_some_and(|here| distance(*here, *point) >= TURNING_METRES) {
            corners.push(*point);
        }
    }
    let directions: Vec<f64> =
        corners.windows(2).map(|pair| (pair[1][1] - pair[0][1]).atan2(pair[1][0] - pair[0][0])).collect();
    directions.windows(2).map(|pair| wrap(pair[1] - pair[0]).abs()).sum::<f64>() / TAU
}

/// The number of pairs of keyframes, one of the first and one of the second half, that see the same place with the same
/// heading.
pub(super) fn landmark_edges(keyframes: &[Option<Pose>]) -> usize {
    let cell = |pose: Pose| ((pose[0] / RADIUS).floor() as i64, (pose[1] / RADIUS).floor() as i64);
    let (early, late) = keyframes.split_at(keyframes.len() / 2);
    let mut cells: HashMap<(i64, i64), Vec<Pose>> = HashMap::new();
    for pose in late.iter().flatten() {
        cells.entry(cell(*pose)).or_default().push(*pose);
    }
    let mut count = 0;
    for pose in early.iter().flatten() {
        let (column, row) = cell(*pose);
        let near = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (column + i, row + j)));
        let others = near.filter_map(|key| cells.get(&key)).flatten();
        count += others
            .filter(|other| distance(*pose, **other) <= RADIUS && wrap(pose[2] - other[2]).abs() <= HEADING)
            .count();
    }
    count
}

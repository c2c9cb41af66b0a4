//! Normals of the walls in a single scan, from the order of its beams.

use nalgebra::{Matrix2, Vector2};
use posecut_scan::LaserScan;

/// A wall is fitted to this many beams on each side of a point at most, and to those within this distance, metres, but at least to
/// the nearest few. Too short a piece has a normal that the noise turns, and such normals hold a scan in place along a corridor.
const REACH: usize = 20;
const LENGTH: f64 = 0.3;
const NEAREST: usize = 3;

/// Two successive points on one wall are no further apart than this share of their range, and this length: at 1 degree a wall that
/// the beam meets at 10 degrees has points 0.1 of the range apart.
const GAP_SHARE: f64 = 0.1;
const GAP: f64 = 0.08;

/// A line through this many points or more has a normal.
const FEWEST: usize = 4;

/// The points' standard deviation from a wall, metres: above it they lie on no line.
const STRAIGHT: f64 = 0.03;

/// A point of a scan with the normal of its wall.
pub(crate) struct Surfel {
    pub(crate) point: Vector2<f64>,
    /// Unit normal towards the scanner.
    pub(crate) normal: Option<Vector2<f64>>,
}

/// The points of a scan in the frame of the robot, in the order of the beams, with normals where they lie on a line: the direction of
/// least variance of the neighbouring beams' points, as long as these have no gap. O(beams).
pub(crate) fn surfels(scan: &LaserScan) -> Vec<Surfel> {
    let points: Vec<(usize, Vector2<f64>)> = scan.numbered_points().collect();
    let joined: Vec<bool> = points
        .windows(2)
        .map(|pair| {
            let [(first, one), (second, other)] = pair else { return false };
            let range = scan.ranges[*first].min(scan.ranges[*second]);
            second - first <= 2 && (other - one).norm() <= GAP + GAP_SHARE * range
        })
        .collect();
    let normal = |index: usize| {
        let near =
            |at: usize| at.abs_diff(index) <= NEAREST || (points[at].1 - points[index].1).norm() <= LENGTH;
        let before = (index.saturating_sub(REACH)..index).rev().take_while(|&at| joined[at] && near(at));
        let after = (index..(index + REACH).min(joined.len())).take_while(|&at| joined[at] && near(at + 1));
        let (start, end) = (before.last().unwrap_or(index), after.last().map_or(index, |at| at + 1));
        let wall: Vec<Vector2<f64>> = points[start..=end].iter().map(|(_, point)| *point).collect();
        line_normal(&wall, &(scan.sensor.translation - points[index].1))
    };
    (0..points.len()).map(|index| Surfel { point: points[index].1, normal: normal(index) }).collect()
}

/// The unit normal of the line through points, on the side of a direction. `None` if the points are too few or on no line.
fn line_normal(points: &[Vector2<f64>], towards: &Vector2<f64>) -> Option<Vector2<f64>> {
    if points.len() < FEWEST {
        return None;
    }
    let mean = points.iter().sum::<Vector2<f64>>() / points.len() as f64;
    let scatter: Matrix2<f64> =
        points.iter().map(|point| (point - mean) * (point - mean).transpose()).sum::<Matrix2<f64>>()
            / points.len() as f64;
    let (small, large, normal) = least_direction(&scatter);
    if small.max(0.0).sqrt() > STRAIGHT || large < 4.0 * small {
        return None;
    }
    Some(if normal.dot(towards) < 0.0 { -normal } else { normal })
}

/// The eigenvalues of a symmetric matrix, the smaller one first, and the unit eigenvector of the smaller one.
pub(crate) fn least_direction(matrix: &Matrix2<f64>) -> (f64, f64, Vector2<f64>) {
    let half = 0.5 * (matrix.m11 - matrix.m22);
    let middle = 0.5 * (matrix.m11 + matrix.m22);
    let radius = half.hypot(matrix.m12);
    // Twice the angle of the larger eigenvector is that of (half, m12).
    let angle = 0.5 * matrix.m12.atan2(half) + std::f64::consts::FRAC_PI_2;
    (middle - radius, middle + radius, Vector2::new(angle.cos(), angle.sin()))
}

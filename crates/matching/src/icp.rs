//! Point-to-line ICP (Censi, *An ICP variant using a point-to-line metric*, ICRA 2008).

use nalgebra::{Matrix3, RowVector3, Vector3};
use posecut_geometry::{LieGroup, SE2};

use crate::information::{Row, determined, information};
use crate::{Cloud, Neighbours};

/// How [`align`] searches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcpOptions {
    /// A point is matched with one within this distance in the first iteration, metres. It halves with each iteration until
    /// [`least_distance`](Self::least_distance).
    pub first_distance: f64,
    /// The distance within which points are matched in the end, metres.
    pub least_distance: f64,
    /// The largest number of iterations.
    pub iterations: usize,
    /// The least standard deviation of a point across its wall, metres: that of the sensor.
    pub least_deviation: f64,
    /// The match's covariance has at least these variances along x, y, theta, m^2 and rad^2: what all points of a scan have in common.
    pub floor: [f64; 3],
}

impl Default for IcpOptions {
    fn default() -> Self {
        Self {
            first_distance: 0.5,
            least_distance: 0.15,
            iterations: 30,
            least_deviation: 0.01,
            floor: [1e-4, 1e-4, 1e-5],
        }
    }
}

/// A match of two clouds.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// The pose of the query in the frame of the reference.
    pub pose: SE2,
    /// The information matrix of a right perturbation of the pose, order x, y, theta, in 1/m^2, 1/(m rad) and 1/rad^2.
    pub information: Matrix3<f64>,
    /// The number of points that were matched.
    pub matched: usize,
    /// The robust standard deviation of their residuals, metres.
    pub deviation: f64,
    /// Whether the pose came to rest before the limit of iterations.
    pub converged: bool,
}

/// Normals of matched points differ by less than 45 degrees.
const FACING: f64 = 0.7;

/// The pose has come to rest when it changes by less than this, metres and radians.
const REST: f64 = 1e-5;

/// Aligns a query to a reference from a pose that is nearly right. The index must be that of the reference's points, with a radius of at
/// least `first_distance`. `None` if fewer than ten points match. O(iterations * query points).
pub fn align(
    reference: &Cloud,
    index: &Neighbours,
    query: &Cloud,
    start: &SE2,
    options: &IcpOptions,
) -> Option<Alignment> {
    let mut pose = *start;
    let mut distance = options.first_distance;
    let mut converged = false;
    let mut rows = Vec::with_capacity(query.len());
    let mut residuals = Vec::with_capacity(query.len());
    let mut deviation = options.least_deviation;
    for _ in 0..options.iterations {
        matches(reference, index, query, &pose, distance, &mut rows, &mut residuals);
        if rows.len() < 10 {
            return None;
        }
        deviation = robust_deviation(&residuals).max(options.least_deviation);
        weigh(&mut rows, &residuals, deviation);
        let step = gauss_newton_step(&rows, &residuals);
        pose = pose.compose(&SE2::exp(&step));
        let small = step.amax() < REST;
        if small && distance <= options.least_distance {
            converged = true;
            break;
        }
        distance = (0.5 * distance).max(options.least_distance);
    }
    let matched = rows.len();
    Some(Alignment {
        pose,
        information: information(&mut rows, deviation, options.floor),
        matched,
        deviation,
        converged,
    })
}

/// The rows and residuals of all points of the query that have a partner within a distance on a wall that faces the same way.
fn matches(
    reference: &Cloud,
    index: &Neighbours,
    query: &Cloud,
    pose: &SE2,
    distance: f64,
    rows: &mut Vec<Row>,
    residuals: &mut Vec<f64>,
) {
    rows.clear();
    residuals.clear();
    for (point, normal) in query.points.iter().zip(&query.normals) {
        let here = pose.translation + pose.rotation * point;
        let turned = normal.map(|normal| pose.rotation * normal);
        let faces = |at: usize| match (reference.normals[at], turned) {
            (Some(wall), Some(turned)) => wall.dot(&turned) > FACING,
            (Some(_), None) => true,
            (None, _) => false,
        };
        let Some((partner, _)) = index.nearest(&here, distance, faces) else { continue };
        let Some(wall) = reference.normals[partner] else { continue };
        // T Exp(xi) p = T (p + v + omega x p): the row in the frame of the query.
        let across = pose.rotation.inverse() * wall;
        let jacobian = RowVector3::new(across.x, across.y, across.y * point.x - across.x * point.y);
        rows.push(Row { jacobian, reference: partner, weight: 1.0 });
        residuals.push(wall.dot(&(here - reference.points[partner])));
    }
}

/// Huber's weights at 1.5 deviations.
fn weigh(rows: &mut [Row], residuals: &[f64], deviation: f64) {
    for (row, residual) in rows.iter_mut().zip(residuals) {
        row.weight = (1.5 * deviation / residual.abs().max(f64::MIN_POSITIVE)).min(1.0);
    }
}

/// The standard deviation of normal values of which some are gross errors: 1.4826 times the median of their sizes; 0 of none. O(values).
pub fn robust_deviation(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() {
        return 0.0;
    }
    1.4826 * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// `-H^+ g`, where directions that the points do not determine stay still.
fn gauss_newton_step(rows: &[Row], residuals: &[f64]) -> Vector3<f64> {
    let mut hessian = Matrix3::zeros();
    let mut gradient = Vector3::zeros();
    for (row, residual) in rows.iter().zip(residuals) {
        let weighted = row.jacobian.transpose() * row.weight;
        hessian += weighted * row.jacobian;
        gradient += weighted * *residual;
    }
    let eigen = determined(hessian, rows.len());
    let mut step = Vector3::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > 0.0 {
            step -= vector * (vector.dot(&gradient) / value);
        }
    }
    step
}

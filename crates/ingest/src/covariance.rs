//! Covariance of the odometry between two keyframes.

use nalgebra::{Matrix3, Matrix6, SMatrix};
use posecut_geometry::covariance::{information_from_covariance, pack_upper_triangle};
use posecut_geometry::{LieGroup, SE3};

use crate::{IngestError, Table, Trajectory};

/// Covariances of the small steps between the rows of an odometry file, in the frame of the later row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StepCovariances {
    file: String,
    times: Vec<i64>,
    covariances: Vec<Matrix6<f64>>,
}

impl StepCovariances {
    /// Builds the covariances from NCLT's 21 upper-triangle terms in the order x, y, z, roll, pitch, yaw. For steps of
    /// a fraction of a second, Euler angles and the rotation vector agree to second order.
    pub(crate) fn from_table(table: &Table) -> Self {
        let covariances = table
            .rows
            .iter()
            .map(|row| {
                let mut matrix = Matrix6::zeros();
                let mut terms = row.iter();
                for i in 0..6 {
                    for j in i..6 {
                        let term = terms.next().copied().unwrap_or(0.0);
                        matrix[(i, j)] = term;
                        matrix[(j, i)] = term;
                    }
                }
                matrix
            })
            .collect();
        Self { file: table.file.clone(), times: table.times.clone(), covariances }
    }

    /// The covariance of the motion between two times, in the frame of the later pose: the sum of the covariances of
    /// the steps between them, each carried to that frame by the adjoint (first order). O(steps).
    pub(crate) fn between(&self, trajectory: &Trajectory, from: i64, to: i64) -> Matrix6<f64> {
        let Some(end) = trajectory.at(to) else { return Matrix6::zeros() };
        let first = self.times.partition_point(|&time| time <= from);
        let last = self.times.partition_point(|&time| time <= to);
        let mut sum = Matrix6::zeros();
        for (time, covariance) in self.times[first..last].iter().zip(&self.covariances[first..last]) {
            let Some(pose) = trajectory.at(*time) else { continue };
            let adjoint = end.between(&pose).adjoint();
            sum += adjoint * covariance * adjoint.transpose();
        }
        sum
    }

    /// The information matrix of the motion: for all six degrees of freedom, or for x, y and heading.
    pub(crate) fn information_between(
        &self,
        trajectory: &Trajectory,
        from: i64,
        to: i64,
        planar: bool,
    ) -> Result<Vec<f64>, IngestError> {
        let covariance = self.between(trajectory, from, to);
        let packed = if planar {
            let kept = [0, 1, 5];
            packed_information(&Matrix3::from_fn(|i, j| covariance[(kept[i], kept[j])]))
        } else {
            packed_information(&covariance)
        };
        packed.map_err(|error| {
            IngestError::session(
                &self.file,
                format!("the covariance of the motion from {from} to {to} us cannot be used ({error})"),
                "set --sigma-translation and --sigma-rotation instead",
            )
        })
    }
}

fn packed_information<const DOF: usize>(covariance: &SMatrix<f64, DOF, DOF>) -> Result<Vec<f64>, String> {
    information_from_covariance(covariance)
        .map(|information| pack_upper_triangle(&information))
        .map_err(|error| error.to_string())
}

/// The logarithm of the difference between a measured and a true motion, for statistics.
pub(crate) fn step_error(measured: &SE3, truth: &SE3) -> [f64; 6] {
    measured.between(truth).log().into()
}

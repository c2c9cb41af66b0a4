//! TORO pose graphs: `VERTEX2`, `EDGE2`, `VERTEX3`, `EDGE3`.
//!
//! Poses are `x y theta` or `x y z roll pitch yaw` with `R = R_z(yaw) R_y(pitch) R_x(roll)`, radians. An information
//! matrix belongs to the printed numbers of the measurement: an error adds to `x y z`, in the frame of the edge's first
//! vertex, and to the angles. Our matrix, like g2o's, belongs to a right perturbation, in the frame of the second
//! vertex. With `B = diag(R_z^T, E)`, where `R_z` is the measured rotation and `E` maps rates of roll, pitch and yaw to
//! the rate of rotation in the body, `Omega_toro = B^T Omega B`. The order of a planar matrix's terms is
//! `xx xy yy tt xt yt`.

use std::io::BufRead;

use nalgebra::{DMatrix, Matrix3};
use posecut_geometry::{LieGroup, SE3};
use posecut_graph::{Dimension, PoseGraph};

use crate::ConvertError;
use crate::g2o::{self, Dialect, ReadOptions, ReadSummary, WriteSummary};
use crate::record::line;

/// If the cosine of the pitch is below this, roll and yaw turn about the same axis to working precision.
const GIMBAL_LOCK: f64 = 1e-6;

/// Reads a TORO file, with lines in any order, as [`g2o::read`] does.
pub fn read(
    file: &str,
    reader: impl BufRead,
    options: &ReadOptions,
) -> Result<(PoseGraph, ReadSummary), ConvertError> {
    read_several(vec![(file.to_owned(), reader)], options)
}

/// Reads TORO files into one graph, as [`g2o::read_several`] does.
pub fn read_several(
    files: Vec<(String, impl BufRead)>,
    options: &ReadOptions,
) -> Result<(PoseGraph, ReadSummary), ConvertError> {
    g2o::read_dialect(files, options, Dialect::Toro)
}

/// Writes a TORO file: vertices, and edges in use (all edges with `keep_rejected`). It is an error if the pitch of a
/// measurement is a right angle, because its roll and yaw then have no information matrix.
pub fn write(graph: &PoseGraph, keep_rejected: bool) -> Result<(Vec<u8>, WriteSummary), ConvertError> {
    let dimension = graph.header.dimension;
    let (vertex, edge_tag) = match dimension {
        Dimension::Two => ("VERTEX2", "EDGE2"),
        Dimension::Three => ("VERTEX3", "EDGE3"),
    };
    let mut summary = WriteSummary::default();
    let mut text = String::new();
    for node in &graph.nodes {
        match &node.pose {
            Some(pose) => line(&mut text, vertex, &[node.id], &pose_to_toro(dimension, pose)),
            None => summary.without_pose += 1,
        }
    }
    for edge in &graph.edges {
        if !edge.in_use() && !keep_rejected {
            summary.rejected += 1;
            continue;
        }
        let (Some(measurement), Some(information)) = (&edge.measurement, graph.information(edge)) else {
            summary.unmeasured += 1;
            continue;
        };
        let mut numbers = pose_to_toro(dimension, measurement);
        let perturbation = perturbation(dimension, &numbers).ok_or_else(|| {
            ConvertError::graph(
                format!(
                    "{}: the measured pitch is a right angle, where roll and yaw are indistinguishable",
                    edge.name()
                ),
                "TORO cannot represent the information matrix there; write g2o",
            )
        })?;
        let information = unpack(dimension, information);
        numbers.extend(pack(dimension, &(perturbation.transpose() * information * perturbation)));
        line(&mut text, edge_tag, &[edge.from, edge.to], &numbers);
    }
    summary.priors = graph.priors.iter().filter(|prior| prior.in_use() || keep_rejected).count();
    Ok((text.into_bytes(), summary))
}

/// The number of components of a pose.
pub(crate) fn pose_numbers(dimension: Dimension) -> usize {
    dimension.degrees_of_freedom()
}

/// Our components of a pose, from those that TORO prints.
pub(crate) fn pose_from_toro(pose: Vec<f64>) -> Vec<f64> {
    match *pose.as_slice() {
        [x, y, z, roll, pitch, yaw] => SE3::from_euler(x, y, z, roll, pitch, yaw).components(),
        _ => pose,
    }
}

fn pose_to_toro(dimension: Dimension, pose: &[f64]) -> Vec<f64> {
    match SE3::from_components(pose).filter(|_| dimension == Dimension::Three) {
        Some(spatial) => {
            let (roll, pitch, yaw) = spatial.euler();
            vec![pose[0], pose[1], pose[2], roll, pitch, yaw]
        }
        None => pose.to_vec(),
    }
}

/// Our packed information of a measurement, from the numbers of its line; `None` if the pitch is a right angle.
pub(crate) fn information_from_toro(
    dimension: Dimension,
    measurement: &[f64],
    terms: &[f64],
) -> Option<Vec<f64>> {
    let printed = match (dimension, terms) {
        (Dimension::Two, &[xx, xy, yy, tt, xt, yt]) => vec![xx, xy, xt, yy, yt, tt],
        _ => terms.to_vec(),
    };
    let inverse = perturbation(dimension, measurement)?.try_inverse()?;
    let information = inverse.transpose() * unpack(dimension, &printed) * inverse;
    Some(upper_triangle(&information))
}

/// `B`: maps errors of the printed numbers to the right perturbation.
fn perturbation(dimension: Dimension, measurement: &[f64]) -> Option<DMatrix<f64>> {
    let side = dimension.degrees_of_freedom();
    let mut matrix = DMatrix::identity(side, side);
    match *measurement {
        [_, _, theta] => {
            let (sine, cosine) = theta.sin_cos();
            matrix[(0, 0)] = cosine;
            matrix[(0, 1)] = sine;
            matrix[(1, 0)] = -sine;
            matrix[(1, 1)] = cosine;
        }
        [_, _, _, roll, pitch, yaw] => {
            let ((sr, cr), (sp, cp)) = (roll.sin_cos(), pitch.sin_cos());
            if cp.abs() < GIMBAL_LOCK {
                return None;
            }
            let rotation = SE3::from_euler(0.0, 0.0, 0.0, roll, pitch, yaw).rotation.to_rotation_matrix();
            matrix.view_mut((0, 0), (3, 3)).copy_from(&rotation.matrix().transpose());
            let rates = Matrix3::new(1.0, 0.0, -sp, 0.0, cr, sr * cp, 0.0, -sr, cr * cp);
            matrix.view_mut((3, 3), (3, 3)).copy_from(&rates);
        }
        _ => return None,
    }
    Some(matrix)
}

fn unpack(dimension: Dimension, packed: &[f64]) -> DMatrix<f64> {
    crate::information::unpack(dimension.degrees_of_freedom(), packed)
}

fn upper_triangle(matrix: &DMatrix<f64>) -> Vec<f64> {
    let side = matrix.nrows();
    (0..side).flat_map(|row| (row..side).map(move |column| matrix[(row, column)])).collect()
}

/// The terms of the matrix in the file's order.
fn pack(dimension: Dimension, matrix: &DMatrix<f64>) -> Vec<f64> {
    let terms = upper_triangle(matrix);
    match (dimension, terms.as_slice()) {
        (Dimension::Two, &[xx, xy, xt, yy, yt, tt]) => vec![xx, xy, yy, tt, xt, yt],
        _ => terms,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    /// Checks that `B` is the derivative of the right perturbation with respect to the printed numbers.
    #[test]
    fn errors_of_the_printed_numbers_are_right_perturbations() {
        let numbers = [1.0, -2.0, 0.5, 0.7, -1.1, 2.6];
        let matrix = perturbation(Dimension::Three, &numbers).unwrap();
        let pose = |n: [f64; 6]| SE3::from_euler(n[0], n[1], n[2], n[3], n[4], n[5]);
        for axis in 0..6 {
            let at = |step: f64| {
                let mut moved = numbers;
                moved[axis] += step;
                pose(numbers).between(&pose(moved)).log()
            };
            let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
            let slope = DVector::from_column_slice(slope.as_slice());
            assert!((matrix.column(axis) - &slope).amax() < 1e-8, "{axis}: {slope}");
        }
        assert!(
            perturbation(Dimension::Three, &[0.0, 0.0, 0.0, 0.0, std::f64::consts::FRAC_PI_2, 0.0]).is_none()
        );
    }
}

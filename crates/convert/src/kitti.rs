//! KITTI trajectories: twelve numbers a line, the 3x4 matrix [R t] of a pose, row by row.

use std::fmt::Write as _;
use std::io::BufRead;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{Dimension, Header, Node, PoseGraph};

use crate::ConvertError;
use crate::trajectory_lines::{Layout, numbers};
use crate::tum::{Poses, spatial_poses};

/// How far R may be from a rotation; files have about six printed digits.
const ROTATION_TOLERANCE: f64 = 1e-3;

const LAYOUT: Layout = Layout { count: 12, described: "12 numbers", format: "KITTI", comments: false };

/// Reads a trajectory as a graph of dimension 3 without edges or times.
pub fn read(file: &str, reader: impl BufRead, session: &str) -> Result<PoseGraph, ConvertError> {
    let mut graph = PoseGraph::new(Header::new(Dimension::Three));
    for line in numbers(file, reader, &LAYOUT) {
        let (place, n) = line?;
        let matrix = Matrix3::new(n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]);
        let off = (matrix * matrix.transpose() - Matrix3::identity()).norm();
        if !(off <= ROTATION_TOLERANCE && matrix.determinant() > 0.0) {
            return Err(ConvertError::line(
                file,
                place,
                format!("the first three columns are not a rotation matrix (off by {off:.1e})"),
                "the order is r11 r12 r13 x r21 r22 r23 y r31 r32 r33 z",
            ));
        }
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
        let id = graph.nodes.len() as u64;
        graph.nodes.push(Node {
            id,
            session: Some(session.to_owned()),
            frame: Some(id as i64),
            pose: Some(SE3::new(Vector3::new(n[3], n[7], n[11]), rotation).components()),
            ..Node::default()
        });
    }
    Ok(graph)
}

/// Writes the poses of a graph in the order of its nodes.
pub fn write(graph: &PoseGraph, poses: Poses, session: Option<&str>) -> Result<Vec<u8>, ConvertError> {
    let mut text = String::new();
    for (_, pose) in spatial_poses(graph, poses, session) {
        let Some(pose) = SE3::from_components(&pose) else { continue };
        let (rotation, place) = (pose.rotation.to_rotation_matrix(), pose.translation);
        for row in 0..3 {
            let m = rotation.matrix();
            let gap = if row == 0 { "" } else { " " };
            // Writing to a string cannot fail.
            let _ = write!(text, "{gap}{} {} {} {}", m[(row, 0)], m[(row, 1)], m[(row, 2)], place[row]);
        }
        text.push('\n');
    }
    if text.is_empty() {
        return Err(ConvertError::graph(
            "no node has a pose of the kind that --poses selects",
            "optimise the graph first, or use --poses truth",
        ));
    }
    Ok(text.into_bytes())
}

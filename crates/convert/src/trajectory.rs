//! Turns trajectories into graphs that can be optimised, and spatial ones into planar ones.

use std::collections::HashMap;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use posecut_geometry::covariance::isotropic_information;
use posecut_geometry::{LieGroup, SE3};
use posecut_graph::{Dimension, Edge, EdgeKind, PoseGraph, for_dimension};
use serde::Serialize;

use crate::ConvertError;
use crate::error::check_sigma;

/// Heights of a planar trajectory vary by no more than this, metres, or by this share of its extent.
const PLANAR_HEIGHT: (f64, f64) = (1.0, 0.05);

/// The poses of a planar trajectory tilt by no more than this, degrees.
const PLANAR_TILT: f64 = 15.0;

/// The axes of the poses of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Axes {
    /// x forward, y left, z up
    Robot,
    /// x right, y down, z forward
    Camera,
}

/// Projects a spatial graph without edges to the plane: x, y and the heading about the vertical axis.
///
/// It is an error if heights vary by more than 1 m and by more than 5 % of the extent, or if a pose tilts by more than 15 degrees,
/// unless `flatten` is set. O(nodes).
pub fn project(graph: &mut PoseGraph, axes: Axes, flatten: bool) -> Result<(), ConvertError> {
    if graph.header.dimension == Dimension::Two {
        return Ok(());
    }
    if !graph.edges.is_empty() {
        return Err(ConvertError::graph(
            "--dimension 2 projects trajectories, but the graph has edges",
            "leave --dimension out; information matrices of space have no projection to the plane",
        ));
    }
    let turned = |pose: &[f64]| SE3::from_components(pose).map(|pose| turn(&pose, axes));
    let poses: Vec<SE3> = graph.nodes.iter().filter_map(|node| turned(node.pose.as_deref()?)).collect();
    if !flatten {
        check_planar(&poses, axes)?;
    }
    for node in &mut graph.nodes {
        if let Some(pose) = &mut node.pose
            && let Some(spatial) = turned(pose)
        {
            *pose = spatial.to_planar().components();
        }
    }
    graph.header.dimension = Dimension::Two;
    Ok(())
}

/// The pose in a frame with x forward, y left, z up, and of a body with these axes.
fn turn(pose: &SE3, axes: Axes) -> SE3 {
    match axes {
        Axes::Robot => *pose,
        Axes::Camera => {
            // The columns are the camera's axes x (right), y (down), z (forward) in those of a robot.
            let columns = [-Vector3::y(), -Vector3::z(), Vector3::x()];
            let matrix = Rotation3::from_basis_unchecked(&columns);
            let rotation = UnitQuaternion::from_rotation_matrix(&matrix);
            SE3::new(rotation * pose.translation, rotation * pose.rotation * rotation.inverse())
        }
    }
}

fn check_planar(poses: &[SE3], axes: Axes) -> Result<(), ConvertError> {
    let range = |axis: usize| {
        let values = || poses.iter().map(|pose| pose.translation[axis]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let height = range(2);
    let extent = range(0).hypot(range(1));
    let tilt = poses
        .iter()
        .map(|pose| (pose.rotation * Vector3::z()).z.clamp(-1.0, 1.0).acos().to_degrees())
        .fold(0.0, f64::max);
    if height > PLANAR_HEIGHT.0.max(PLANAR_HEIGHT.1 * extent) || tilt > PLANAR_TILT {
        let (axes, other) = match axes {
            Axes::Robot => ("x forward, z up", "--axes camera"),
            Axes::Camera => ("z forward, y down", "--axes robot"),
        };
        return Err(ConvertError::graph(
            format!(
                "the trajectory is not near a plane if its axes are {axes}: its height varies by {height:.1} m over an extent of {extent:.1} m, and its poses tilt by up to {tilt:.0} degrees"
            ),
            format!("set {other} if these are its axes, or project it anyway with --flatten"),
        ));
    }
    Ok(())
}

/// Joins the poses of each session, in the order of their ids, by odometry edges with these standard deviations of each axis in
/// metres and radians. Returns the number of edges. It is an error if the graph has odometry already. O(nodes).
pub fn add_odometry(
    graph: &mut PoseGraph,
    sigma_translation: f64,
    sigma_rotation: f64,
) -> Result<usize, ConvertError> {
    check_sigma("--sigma-translation", Some(sigma_translation))?;
    check_sigma("--sigma-rotation", Some(sigma_rotation))?;
    if let Some(edge) = graph.edges_of(EdgeKind::Odometry).next() {
        return Err(ConvertError::graph(
            format!("--odometry-from-poses adds odometry, but the graph has some already ({})", edge.name()),
            "leave the option out",
        ));
    }
    let edges = for_dimension!(graph.header.dimension, |G, DOF| {
        let information = isotropic_information(DOF, sigma_translation, sigma_rotation);
        steps::<G, DOF>(graph, &information)?
    });
    let count = edges.len();
    graph.edges.extend(edges);
    Ok(count)
}

fn steps<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    information: &[f64],
) -> Result<Vec<Edge>, ConvertError> {
    let mut last: HashMap<Option<&str>, (u64, G)> = HashMap::new();
    let mut edges = Vec::new();
    let mut id = graph.edges.iter().map(|edge| edge.id).max().map_or(Some(0), |id| id.checked_add(1));
    for node in &graph.nodes {
        let Some(pose) = node.pose.as_deref().and_then(G::from_components) else { continue };
        let Some((before, known)) = last.insert(node.session.as_deref(), (node.id, pose)) else { continue };
        let unused = id.ok_or_else(|| {
            ConvertError::graph("no edge id above 2^64 - 1 is left", "renumber the edges of the graph")
        })?;
        let mut edge = Edge::new(EdgeKind::Odometry, unused, before, node.id);
        edge.measurement = Some(known.between(&pose).components());
        edge.information = Some(information.to_vec());
        edges.push(edge);
        id = unused.checked_add(1);
    }
    Ok(edges)
}

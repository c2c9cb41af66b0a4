//! Changes of a graph that do not change its meaning.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_geometry::covariance::{pack_upper_triangle, unpack_upper_triangle};
use posecut_graph::{Edge, EdgeKind, PoseGraph};

/// Other ids of landmark edges. Decisions that depend on the order of ids may change.
pub(crate) const OTHER_IDS: &str = "ids of landmark edges in reverse order";
/// Another scale of all information matrices.
pub(crate) const OTHER_INFORMATION: &str = "information times 1e-3";

fn packed<const DOF: usize>(edge: &Edge) -> SMatrix<f64, DOF, DOF> {
    unpack_upper_triangle(edge.information.as_ref().unwrap()).unwrap()
}

pub(crate) fn is_landmark(edge: &Edge) -> bool {
    edge.kind == EdgeKind::Landmark
}

/// Converts a graph to another unit of length; one metre is `unit` of them.
fn in_units<const DOF: usize>(graph: &mut PoseGraph, unit: f64) {
    let translations = if DOF == 6 { 3 } else { 2 };
    let shrink =
        SMatrix::from_diagonal(&SVector::from_fn(
            |axis, _| if axis < translations { 1.0 / unit } else { 1.0 },
        ));
    let stretch = |pose: &mut Vec<f64>| pose[..translations].iter_mut().for_each(|value| *value *= unit);
    graph.nodes.iter_mut().filter_map(|node| node.pose.as_mut()).for_each(stretch);
    for edge in &mut graph.edges {
        edge.measurement.as_mut().into_iter().for_each(stretch);
        edge.information = Some(pack_upper_triangle(&(shrink * packed::<DOF>(edge) * shrink)));
    }
}

/// Reverses an edge: the error of Z^-1 is -Ad(Z) e.
fn reverse<G: LieGroup<DOF>, const DOF: usize>(edge: &mut Edge) {
    let back = G::from_components(edge.measurement.as_ref().unwrap()).unwrap().inverse();
    let information = back.adjoint().transpose() * packed::<DOF>(edge) * back.adjoint();
    (edge.from, edge.to) = (edge.to, edge.from);
    edge.measurement = Some(back.components());
    edge.information = Some(pack_upper_triangle(&((information + information.transpose()) * 0.5)));
}

/// A change of the graph: its name, the change, and the new id of each landmark edge.
pub(crate) type Change = (&'static str, fn(&mut PoseGraph), fn(u64) -> u64);

/// An id greater than all drawn ids.
pub(crate) const FAR: u64 = 10_000;

#[expect(clippy::too_many_lines, reason = "a list")]
pub(crate) fn changes<G: LieGroup<DOF>, const DOF: usize>() -> Vec<Change> {
    vec![
        ("millimetres", |graph| in_units::<DOF>(graph, 1e3), |id| id),
        ("kilometres", |graph| in_units::<DOF>(graph, 1e-3), |id| id),
        (
            OTHER_INFORMATION,
            |graph| {
                let terms = graph.edges.iter_mut().filter_map(|edge| edge.information.as_mut()).flatten();
                terms.for_each(|term| *term *= 1e-3);
            },
            |id| id,
        ),
        (
            "ids of nodes far apart",
            |graph| {
                graph.nodes.iter_mut().for_each(|node| node.id = 3 * node.id + 7);
                for edge in &mut graph.edges {
                    (edge.from, edge.to) = (3 * edge.from + 7, 3 * edge.to + 7);
                }
            },
            |id| id,
        ),
        (
            OTHER_IDS,
            |graph| {
                graph
                    .edges
                    .iter_mut()
                    .filter(|edge| is_landmark(edge))
                    .for_each(|edge| edge.id = FAR - edge.id);
                graph.sort();
            },
            |id| FAR - id,
        ),
        (
            "landmark edges reversed",
            |graph| graph.edges.iter_mut().filter(|edge| is_landmark(edge)).for_each(reverse::<G, DOF>),
            |id| id,
        ),
        (
            "every other landmark edge reversed",
            |graph| {
                let landmarks = graph.edges.iter_mut().filter(|edge| is_landmark(edge) && edge.id % 2 == 0);
                landmarks.for_each(reverse::<G, DOF>);
            },
            |id| id,
        ),
        (
            "odometry reversed",
            |graph| graph.edges.iter_mut().filter(|edge| !is_landmark(edge)).for_each(reverse::<G, DOF>),
            |id| id,
        ),
        (
            "sessions renamed",
            |graph| {
                for session in graph.nodes.iter_mut().filter_map(|node| node.session.as_mut()) {
                    let name = if session == "a" { "z, the first" } else { "0" };
                    name.clone_into(session);
                }
            },
            |id| id,
        ),
        (
            "a rigid motion",
            |graph| {
                let motion = G::exp(&SVector::from_fn(|axis, _| 3.0 - 1.3 * axis as f64));
                for pose in graph.nodes.iter_mut().filter_map(|node| node.pose.as_mut()) {
                    *pose = motion.compose(&G::from_components(pose).unwrap()).components();
                }
            },
            |id| id,
        ),
        (
            "another session without connection",
            |graph| {
                let of_a =
                    |id: u64| graph.nodes[graph.node_index(id).unwrap()].session.as_deref() == Some("a");
                let odometry = graph.edges.iter().filter(|edge| !is_landmark(edge) && of_a(edge.from));
                let copies: Vec<Edge> = odometry
                    .map(|edge| Edge {
                        id: edge.id + FAR,
                        from: edge.from + FAR,
                        to: edge.to + FAR,
                        ..edge.clone()
                    })
                    .collect();
                let nodes = graph.nodes.iter().filter(|node| node.session.as_deref() == Some("a"));
                let nodes: Vec<_> = nodes
                    .map(|node| {
                        let mut copy = node.clone();
                        copy.id += FAR;
                        copy.session = Some("c".to_owned());
                        copy
                    })
                    .collect();
                graph.nodes.extend(nodes);
                graph.edges.extend(copies);
                graph.sort();
            },
            |id| id,
        ),
    ]
}

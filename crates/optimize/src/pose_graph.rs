//! Reads a pose graph for the algorithms: the edges in use that have a measurement, and the fixed nodes.

use posecut_geometry::LieGroup;
use posecut_graph::{Node, PoseGraph};

use crate::{Edge, EdgeKind};

/// The indices of the fixed nodes.
pub fn fixed_nodes(graph: &PoseGraph) -> anyhow::Result<Vec<usize>> {
    let mut fixed = Vec::new();
    for (place, node) in graph.nodes.iter().enumerate() {
        if is_fixed(node)? {
            fixed.push(place);
        }
    }
    Ok(fixed)
}

/// Whether a node is fixed; its pose must then be known.
pub fn is_fixed(node: &Node) -> anyhow::Result<bool> {
    let fixed = node.is_fixed().map_err(|value| {
        anyhow::anyhow!(
            "node {}, field \"fixed\": expected true or false, found {value}; give true to fix the node at its pose",
            node.id
        )
    })?;
    anyhow::ensure!(
        !fixed || node.pose.is_some(),
        "node {} is fixed but has no pose; give it one, or remove the field \"fixed\"",
        node.id
    );
    Ok(fixed)
}

/// The edges in use that have a measurement.
#[derive(Clone, Debug)]
pub struct Measured<G, const DOF: usize> {
    /// The edges for the library, without kernels; their ends are indices of the graph's nodes.
    pub edges: Vec<Edge<G, DOF>>,
    /// Their indices among the graph's edges.
    pub places: Vec<usize>,
    /// Number of edges in use without a measurement.
    pub unmeasured: usize,
}

/// Reads the edges in use of a pose graph. O(edges).
pub fn edges<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph) -> anyhow::Result<Measured<G, DOF>> {
    let mut found = Measured { edges: Vec::new(), places: Vec::new(), unmeasured: 0 };
    for (place, edge) in graph.edges.iter().enumerate().filter(|(_, edge)| edge.in_use()) {
        let Some((from, to)) = graph.ends(edge) else { continue };
        let Some(measured) = measured_edge(graph, edge, from, to)? else {
            found.unmeasured += 1;
            continue;
        };
        found.edges.push(measured);
        found.places.push(place);
    }
    Ok(found)
}

/// An edge for the library, without kernel, between these node indices; `None` if it has no measurement.
pub fn measured_edge<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    edge: &posecut_graph::Edge,
    from: usize,
    to: usize,
) -> anyhow::Result<Option<Edge<G, DOF>>> {
    let Some((measurement, information)) = graph.measurement::<G, DOF>(edge)? else { return Ok(None) };
    let kind = match edge.kind {
        posecut_graph::EdgeKind::Odometry => EdgeKind::Odometry,
        posecut_graph::EdgeKind::Landmark => EdgeKind::Landmark,
    };
    Ok(Some(Edge::new(from, to, measurement, information, kind)))
}

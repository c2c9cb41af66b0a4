//! Reads a pose graph for the algorithms: the edges in use that have a measurement, the priors in use, and the fixed nodes.

use nalgebra::SMatrix;
use posecut_geometry::covariance::unpack_upper_triangle;
use posecut_geometry::{LieGroup, translations};
use posecut_graph::{Node, PoseGraph, PriorOf};

use crate::{Edge, EdgeKind, Prior};

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

/// The priors in use, without kernels, and their indices among the graph's priors. O(priors).
pub fn priors<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
) -> anyhow::Result<(Vec<Prior<G, DOF>>, Vec<usize>)> {
    let in_use = graph.priors.iter().enumerate().filter(|(_, prior)| prior.in_use());
    let read = |(place, prior)| Ok((read_prior(graph, prior)?, place));
    in_use.map(read).collect::<anyhow::Result<Vec<_>>>().map(|found| found.into_iter().unzip())
}

fn read_prior<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    prior: &posecut_graph::Prior,
) -> anyhow::Result<Prior<G, DOF>> {
    let dimension = graph.header.dimension;
    // Graphs that were read have been checked; those made by a program may not.
    let unusable = |field: &str| anyhow::anyhow!("{}: its {field} cannot be used; correct it", prior.name());
    let node = graph.node_index(prior.node).ok_or_else(|| unusable("node"))?;
    let packed = graph.information_of_prior(prior).ok_or_else(|| unusable("information"))?;
    match prior.of(dimension).ok_or_else(|| unusable("measurement"))? {
        PriorOf::Pose => {
            let pose = G::from_components(&prior.measurement).ok_or_else(|| unusable("measurement"))?;
            let information = unpack_upper_triangle(packed).map_err(|_| unusable("information"))?;
            Ok(Prior::pose(node, pose, information))
        }
        PriorOf::Position => {
            let mut components = dimension.identity();
            components[..translations(DOF)].copy_from_slice(&prior.measurement);
            let at = G::from_components(&components).ok_or_else(|| unusable("measurement"))?;
            let information = of_position(packed).ok_or_else(|| unusable("information"))?;
            Ok(Prior::position(node, at, information))
        }
    }
}

/// The information matrix of a position within that of a pose, with zeros for the rotation.
fn of_position<const DOF: usize>(packed: &[f64]) -> Option<SMatrix<f64, DOF, DOF>> {
    let side = translations(DOF);
    let mut matrix = SMatrix::zeros();
    let mut terms = packed.iter();
    for row in 0..side {
        for column in row..side {
            let &term = terms.next()?;
            (matrix[(row, column)], matrix[(column, row)]) = (term, term);
        }
    }
    terms.next().is_none().then_some(matrix)
}

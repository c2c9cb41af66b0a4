//! Writes g2o.

use std::collections::HashSet;

use posecut_graph::{Dimension, Edge, EdgeKind, PoseGraph, PriorOf};

use super::comment_of_kind;
use crate::odometry::{consecutive, find_missing};
use crate::record::line;

/// What the writer left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteSummary {
    /// Edges left out because a stage has rejected them.
    pub rejected: usize,
    /// Edges left out because they have no measurement.
    pub unmeasured: usize,
    /// Priors left out because a stage has rejected them.
    pub rejected_priors: usize,
    /// Priors left out because the format has none.
    pub priors: usize,
    /// Nodes without a pose: the file has only their edges.
    pub without_pose: usize,
}

/// Writes a g2o file: vertices, `FIX`, and edges and priors in use (all of them with `keep_rejected`). The reader gets back the same
/// bits of every number, and the same kind of every edge.
pub fn write(graph: &PoseGraph, keep_rejected: bool) -> (Vec<u8>, WriteSummary) {
    let (vertex, edge_tag) = match graph.header.dimension {
        Dimension::Two => ("VERTEX_SE2", "EDGE_SE2"),
        Dimension::Three => ("VERTEX_SE3:QUAT", "EDGE_SE3:QUAT"),
    };
    let mut summary = WriteSummary::default();
    let mut text = String::new();
    for node in &graph.nodes {
        match &node.pose {
            Some(pose) => line(&mut text, vertex, &[node.id], pose),
            None => summary.without_pose += 1,
        }
    }
    for node in graph.nodes.iter().filter(|node| node.is_fixed() == Ok(true)) {
        line(&mut text, "FIX", &[node.id], &[]);
    }
    let mut edges = Vec::new();
    let mut numbers = Vec::new();
    for edge in &graph.edges {
        match edge.measurement.as_ref().zip(graph.information(edge)) {
            _ if !edge.in_use() && !keep_rejected => summary.rejected += 1,
            Some(measured) => {
                edges.push(edge);
                numbers.push(measured);
            }
            None => summary.unmeasured += 1,
        }
    }
    let posed = graph.nodes.iter().filter(|node| node.pose.is_some()).map(|node| node.id);
    let stated = kinds_to_state(&posed.chain(edges.iter().flat_map(|edge| [edge.from, edge.to])), &edges);
    for ((edge, (measurement, information)), stated) in edges.iter().zip(numbers).zip(stated) {
        if stated {
            line(&mut text, &comment_of_kind(edge.from, edge.to, edge.kind), &[], &[]);
        }
        let numbers: Vec<f64> = measurement.iter().chain(information).copied().collect();
        line(&mut text, edge_tag, &[edge.from, edge.to], &numbers);
    }
    write_priors(&mut text, graph, keep_rejected, &mut summary);
    (text.into_bytes(), summary)
}

/// Writes priors. In space all have parameter 0, an offset of zero, and a position is a pose without information about its rotation.
fn write_priors(text: &mut String, graph: &PoseGraph, keep_rejected: bool, summary: &mut WriteSummary) {
    let dimension = graph.header.dimension;
    let mut offset = (dimension == Dimension::Three).then(|| dimension.identity());
    for prior in &graph.priors {
        if !prior.in_use() && !keep_rejected {
            summary.rejected_priors += 1;
            continue;
        }
        if let Some(offset) = offset.take() {
            line(text, "PARAMS_SE3OFFSET", &[0], &offset);
        }
        let mut measurement = prior.measurement.clone();
        let mut information = graph.information_of_prior(prior).unwrap_or_default().to_vec();
        let (tag, ids) = match (dimension, prior.of(dimension)) {
            (Dimension::Two, Some(PriorOf::Position)) => ("EDGE_PRIOR_SE2_XY", vec![prior.node]),
            (Dimension::Two, _) => ("EDGE_PRIOR_SE2", vec![prior.node]),
            (Dimension::Three, of) => {
                if of == Some(PriorOf::Position) {
                    measurement.extend(&dimension.identity()[3..]);
                    information = within_pose(&information);
                }
                ("EDGE_SE3_PRIOR", vec![prior.node, 0])
            }
        };
        measurement.extend(information);
        line(text, tag, &ids, &measurement);
    }
}

/// The 21 terms of a pose's information matrix with these 6 terms of a position, and zeros for the rotation.
fn within_pose(position: &[f64]) -> Vec<f64> {
    let mut terms = position.iter().copied();
    let rows = (0..6).flat_map(|row| (row..6).map(move |column| row.max(column)));
    rows.map(|last| if last < 3 { terms.next().unwrap_or_default() } else { 0.0 }).collect()
}

/// For each edge, whether a comment must state its kind, because the reader would infer the other one.
fn kinds_to_state(ids: &(impl Iterator<Item = u64> + Clone), edges: &[&Edge]) -> Vec<bool> {
    let mut successive = HashSet::new();
    let mut stated: Vec<bool> = edges
        .iter()
        .map(|edge| {
            let inferred = consecutive(&mut successive, edge.from, edge.to);
            let states = inferred != edge.kind;
            if states && inferred == EdgeKind::Odometry {
                // The reader does not apply its rule to an edge with a comment.
                successive.remove(&edge.from.min(edge.to));
            }
            states
        })
        .collect();
    // Where a robot has a comment, the reader does not search for missing odometry: no third pass is needed.
    for missing in find_missing(ids, edges, &stated) {
        for index in missing {
            stated[index] = true;
        }
    }
    stated
}

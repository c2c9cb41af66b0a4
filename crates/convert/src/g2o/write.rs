//! Writes g2o.

use std::collections::HashSet;

use posecut_graph::{Dimension, EdgeKind, PoseGraph};

use super::{comment_of_kind, inferred_kind};
use crate::record::line;

/// What the writer left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteSummary {
    /// Edges left out because a stage has rejected them.
    pub rejected: usize,
    /// Edges left out because they have no measurement.
    pub unmeasured: usize,
    /// Nodes without a pose: the file has only their edges.
    pub without_pose: usize,
}

/// Writes a g2o file: vertices, `FIX`, and edges in use (all edges with `keep_rejected`). The reader gets back the same
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
    let mut successive = HashSet::new();
    for edge in &graph.edges {
        if !edge.in_use() && !keep_rejected {
            summary.rejected += 1;
            continue;
        }
        let (Some(measurement), Some(information)) = (&edge.measurement, graph.information(edge)) else {
            summary.unmeasured += 1;
            continue;
        };
        // The kind that the reader would infer. If it is wrong, a comment corrects it, and the reader does not apply
        // its rule.
        let inferred = inferred_kind(&mut successive, edge.from, edge.to);
        if inferred != edge.kind {
            line(&mut text, &comment_of_kind(edge.from, edge.to, edge.kind), &[], &[]);
            if inferred == EdgeKind::Odometry {
                successive.remove(&edge.from.min(edge.to));
            }
        }
        let numbers: Vec<f64> = measurement.iter().chain(information).copied().collect();
        line(&mut text, edge_tag, &[edge.from, edge.to], &numbers);
    }
    (text.into_bytes(), summary)
}

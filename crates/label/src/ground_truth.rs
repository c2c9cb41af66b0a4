//! Labels from ground-truth poses.
//!
//! With the true poses `X_i` and `X_j`, an edge that measures `Z` is correct if its error
//! `E = Z^-1 (X_i^-1 X_j)` moves by less than one tolerance and turns by less than another.

mod chain;
mod track;

use std::collections::HashMap;

use anyhow::{Context as _, bail};
use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{EdgeKind, NodeTruth, PoseGraph};
use posecut_stage::Context;

use crate::{Options, described, set};

/// The true poses of nodes, and the name of their source for messages.
#[derive(Clone, Debug)]
pub struct GroundTruth {
    source: String,
    poses: HashMap<u64, SE3>,
}

/// Reads the ground truth that the options name; `None` if they name none.
pub fn read(
    options: &Options,
    graph: &PoseGraph,
    context: &mut Context,
) -> anyhow::Result<Option<GroundTruth>> {
    let dimension = graph.header.dimension;
    if options.vertices {
        let poses = graph
            .nodes
            .iter()
            .filter_map(|node| Some((node.id, dimension.spatial(node.pose.as_deref()?)?)))
            .collect();
        return Ok(Some(GroundTruth { source: "the graph".to_owned(), poses }));
    }
    let Some(source) = &options.ground_truth else { return Ok(None) };
    if let Some(times) = &options.times {
        let (file, bytes) = context.read_bytes(source, "ground truth")?;
        let (times_file, times) = context.read_bytes(times, "times")?;
        let track = track::Track::read(&file, &bytes)?;
        let times = track::times(&times_file, &times)?;
        let poses = (0_u64..)
            .zip(times)
            .filter_map(|(node, time)| Some((node, track.at(time, options.longest_silence)?.to_spatial())))
            .collect();
        return Ok(Some(GroundTruth { source: file, poses }));
    }
    let name = source.to_string();
    let truth = context.read_graph(source, "ground truth").with_context(|| {
        format!("{name}: cannot be used as ground truth; convert it to JSON Lines with posecut-convert, or name --times for a CSV file of time, x, y, heading")
    })?;
    if truth.header.dimension != dimension {
        bail!("{name}: has dimension {}, the graph {dimension}; both must be alike", truth.header.dimension);
    }
    let poses = chain::poses(&truth);
    if poses.is_empty() {
        bail!("{name}: has neither poses nor odometry to compose them from; name a graph with ground truth");
    }
    Ok(Some(GroundTruth { source: name, poses }))
}

/// Labels edges by the ground truth, and writes it to the nodes.
pub fn apply(graph: &mut PoseGraph, truth: &GroundTruth, options: &Options) -> anyhow::Result<()> {
    let dimension = graph.header.dimension;
    for node in &mut graph.nodes {
        if options.vertices {
            // Remove the pose, so that no method starts from the truth.
            node.pose = None;
        }
        if let Some(pose) = truth.poses.get(&node.id) {
            node.truth.get_or_insert_with(NodeTruth::default).pose = Some(dimension.components(pose));
        }
    }
    for edge in graph.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark) {
        let missing = [edge.from, edge.to].into_iter().find(|end| !truth.poses.contains_key(end));
        if let Some(node) = missing {
            if options.unknown_incorrect {
                set(edge, false);
                continue;
            }
            bail!(
                "{}: has no pose of node {node}, which {} joins; complete it, or say --unknown-incorrect to call such edges incorrect",
                truth.source,
                described(edge)
            );
        }
        let Some(measurement) = edge.measurement.as_deref().and_then(|measured| dimension.spatial(measured))
        else {
            bail!(
                "{}: has no measurement to compare with the ground truth; use --labels or --correct-pairs",
                described(edge)
            );
        };
        let error = measurement.between(&truth.poses[&edge.from].between(&truth.poses[&edge.to]));
        let correct = error.translation.norm() < options.tolerance_translation
            && error.rotation.angle() < options.tolerance_rotation.to_radians();
        set(edge, correct);
    }
    Ok(())
}

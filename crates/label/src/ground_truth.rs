//! Labels from ground-truth poses.
//!
//! With the true poses `X_i` and `X_j`, an edge that measures `Z` is correct if its error
//! `E = Z^-1 (X_i^-1 X_j)` moves by less than one tolerance and turns by less than another.

mod chain;
mod relations;
mod track;

use std::collections::HashMap;

use anyhow::{Context as _, bail};
use posecut_evaluate::relations::{Relation, RelationErrors, Track};
use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{Dimension, EdgeKind, NodeTruth, PoseGraph};
use serde::Serialize;

use crate::{described, set};

/// The true poses of nodes, and the name of their source for messages.
#[derive(Clone, Debug)]
pub struct GroundTruth {
    source: String,
    poses: HashMap<u64, SE3>,
}

/// How edges are compared with the ground truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Comparison {
    /// Label an edge correct if its translation error is below this, metres; `inf` compares rotations alone
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Comparison::DEFAULT.tolerance_translation, help_heading = "Ground truth"))]
    pub tolerance_translation: f64,

    /// Label an edge correct if its rotation error is below this, degrees
    #[cfg_attr(feature = "cli", arg(long, value_name = "DEGREES", default_value_t = Comparison::DEFAULT.tolerance_rotation, help_heading = "Ground truth"))]
    pub tolerance_rotation: f64,

    /// Do not interpolate ground truth across a longer silence than this, seconds
    #[cfg_attr(feature = "cli", arg(long, value_name = "SECONDS", default_value_t = Comparison::DEFAULT.longest_silence, help_heading = "Ground truth"))]
    pub longest_silence: f64,

    /// Label an edge incorrect if an end has no ground truth, instead of failing
    #[cfg_attr(feature = "cli", arg(long, help_heading = "Ground truth"))]
    pub unknown_incorrect: bool,
}

impl Default for Comparison {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Comparison {
    /// Within 2 m and 15 degrees, silences of up to 20 s, and no edge without ground truth.
    pub const DEFAULT: Self = Self {
        tolerance_translation: 2.0,
        tolerance_rotation: 15.0,
        longest_silence: 20.0,
        unknown_incorrect: false,
    };

    /// Refuses meaningless numbers.
    pub fn check(&self) -> anyhow::Result<()> {
        for (name, value) in [
            ("--tolerance-translation", self.tolerance_translation),
            ("--tolerance-rotation", self.tolerance_rotation),
            ("--longest-silence", self.longest_silence),
        ] {
            if !(value > 0.0) {
                bail!("{name} is {value}, but must be a positive number");
            }
        }
        Ok(())
    }
}

impl GroundTruth {
    /// Takes the poses from the nodes of a graph, so that no method starts from the truth.
    pub fn taken_from(graph: &mut PoseGraph) -> Self {
        let dimension = graph.header.dimension;
        let poses = graph
            .nodes
            .iter_mut()
            .filter_map(|node| Some((node.id, dimension.spatial(node.pose.take()?.as_slice())?)))
            .collect();
        Self { source: "the graph".to_owned(), poses }
    }

    /// Interpolates a trajectory at the times of the nodes, the first of node 0. Both files come with their names for
    /// messages: CSV of time, x, y, heading without a header, and times, one a line. A node within a silence longer than
    /// the limit (seconds) has no pose.
    pub fn of_track(
        (file, bytes): (&str, &[u8]),
        (times_file, times): (&str, &[u8]),
        longest_silence: f64,
    ) -> anyhow::Result<Self> {
        let track = track::Track::read(file, bytes)?;
        let times = track::times(times_file, times)?;
        let poses = (0_u64..)
            .zip(times)
            .filter_map(|(node, time)| Some((node, track.at(time, longest_silence)?.to_spatial())))
            .collect();
        Ok(Self { source: file.to_owned(), poses })
    }

    /// The map that follows from a graph's odometry and from measured relations, and how far it is from these. Landmark edges are not
    /// used. `track` has the poses of the log at every scan; messages call the file of relations `name`.
    pub fn of_relations(
        name: &str,
        graph: &PoseGraph,
        relations: &[Relation],
        track: &Track,
    ) -> anyhow::Result<(Self, RelationErrors)> {
        let (poses, errors) = relations::poses(graph, relations, track).with_context(|| name.to_owned())?;
        let poses = graph.nodes.iter().map(|node| node.id).zip(poses).collect();
        Ok((Self { source: name.to_owned(), poses }, errors))
    }

    /// The ground truth of another graph of this dimension: its truth, else its poses, else poses composed along its
    /// odometry. The name is for messages.
    pub fn of_graph(name: &str, truth: &PoseGraph, dimension: Dimension) -> anyhow::Result<Self> {
        if truth.header.dimension != dimension {
            bail!(
                "{name}: has dimension {}, but the graph has {dimension}; use ground truth of the same dimension",
                truth.header.dimension
            );
        }
        let poses = chain::poses(truth);
        if poses.is_empty() {
            bail!(
                "{name}: has neither poses nor odometry to compose them from; name a graph with ground truth"
            );
        }
        Ok(Self { source: name.to_owned(), poses })
    }
}

/// Labels edges by the ground truth, and writes it to the nodes.
pub fn apply(graph: &mut PoseGraph, truth: &GroundTruth, options: &Comparison) -> anyhow::Result<()> {
    let dimension = graph.header.dimension;
    for node in &mut graph.nodes {
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
                "{}: has no pose of node {node}, an end of {}; complete it, or use --unknown-incorrect to label such edges incorrect",
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

//! The result of an evaluation: one JSON document an estimate.

use std::collections::BTreeMap;

use posecut_graph::{Dimension, Node, PoseGraph, StageDoubt};
use serde::Serialize;
use serde_json::Value;

use crate::EvaluateError;
use crate::alignment::{Alignment, Freedom};
use crate::calibration::{Calibration, calibration};
use crate::edges::{EdgeScores, score};
use crate::ground_truth::GroundTruth;
use crate::relations::RelationErrors;
use crate::summary::Summary;
use crate::trajectory::{AbsoluteError, Match, RelativeError, align, errors, relative_error};

/// Whether sessions are aligned together or each by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Scope {
    /// One alignment for all poses: a wrong relative pose of two sessions counts as an error
    #[default]
    Joint,
    /// One alignment per session: only the shape of each counts
    PerSession,
    /// One alignment per connected component of the reference: the same as joint if the reference is connected
    PerComponent,
}

impl Scope {
    /// What messages call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Joint => "all sessions together",
            Self::PerSession => "each session separately",
            Self::PerComponent => "each component of the reference separately",
        }
    }
}

/// The options of evaluation.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Options {
    /// Align by these motions [default: se2 for planar graphs, se3 for spatial graphs]
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub align: Option<Freedom>,

    /// Choose which poses share one alignment
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.scope))]
    pub scope: Scope,

    /// Measure relative errors over this many frames
    #[cfg_attr(feature = "cli", arg(long, value_name = "FRAMES", default_value_t = Options::DEFAULT.rpe_delta, value_parser = clap::value_parser!(u32).range(1..)))]
    pub rpe_delta: u32,

    /// Add this label to the result, for tables; may be repeated
    #[cfg_attr(feature = "cli", arg(long = "label", value_name = "NAME=VALUE"))]
    pub labels: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options {
    /// One alignment for all poses by the motions of the graph's dimension, and relative errors from frame to frame.
    pub const DEFAULT: Self = Self { align: None, scope: Scope::Joint, rpe_delta: 1, labels: Vec::new() };
}

/// The result of an evaluation.
#[derive(Clone, Debug, Serialize)]
pub struct EvaluationResult {
    format: &'static str,
    version: u64,
    /// The caller's labels of this run.
    pub labels: BTreeMap<String, Value>,
    /// Root mean square distance over all common poses after alignment, metres; `None` if there is nothing to compare with but
    /// relations.
    pub rmse: Option<f64>,
    /// How the poses were aligned before the errors were measured.
    pub alignment: AlignmentUsed,
    /// Components of the estimate over the edges in use. If there are several, their relative poses are unknown.
    pub components: usize,
    /// Nodes compared.
    pub poses: usize,
    /// Nodes of the estimate without counterpart.
    pub poses_unmatched: usize,
    /// Distances of the estimate and of the reference from the ground truth; absent without a reference or a ground truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_truth: Option<GroundTruth>,
    /// Absolute trajectory error.
    pub ate: AbsoluteError,
    /// Relative pose error.
    pub rpe: RelativeError,
    /// Errors of relative motions that were measured by hand; absent without them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relations: Option<RelationErrors>,
    /// The absolute translation error of each session under the same alignment.
    pub sessions: BTreeMap<String, Summary>,
    /// Precision and recall of landmark edges; absent if no edge's truth is known.
    pub edges: Option<EdgeScores>,
    /// Landmark edges by bins of `verify_probability`; absent if no edge has both a probability and a known truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<Calibration>,
    /// The doubts of the stages that produced the estimate, oldest first, and of evaluation itself; absent if there are
    /// none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<StageDoubt>,
    /// The estimate's history.
    pub provenance: Vec<Value>,
}

/// The name and numbers of an alignment.
#[derive(Clone, Debug, Serialize)]
pub struct AlignmentUsed {
    /// The allowed motions.
    pub freedom: Freedom,
    /// Which poses share an alignment.
    pub scope: Scope,
    /// The alignments: one for all, one a session, or one a component (named by its first node).
    pub found: BTreeMap<String, AlignmentFound>,
}

/// p -> scale * Exp(`rotation_vector`) p + translation.
#[derive(Clone, Debug, Serialize)]
pub struct AlignmentFound {
    /// Radians.
    pub rotation_vector: [f64; 3],
    /// Metres.
    pub translation: [f64; 3],
    /// 1 for rigid motions.
    pub scale: f64,
}

/// Compares an estimate with a reference graph, or with the estimate's own ground truth. O(nodes log nodes).
pub fn evaluate(
    estimate: &PoseGraph,
    reference: Option<&PoseGraph>,
    options: &Options,
) -> Result<EvaluationResult, EvaluateError> {
    evaluate_with_relations(estimate, reference, None, options)
}

/// The same, with the errors of relations, which need no other ground truth.
pub fn evaluate_with_relations(
    estimate: &PoseGraph,
    reference: Option<&PoseGraph>,
    relations: Option<RelationErrors>,
    options: &Options,
) -> Result<EvaluationResult, EvaluateError> {
    if let Some(reference) = reference
        && reference.header.dimension != estimate.header.dimension
    {
        return Err(EvaluateError::Dimension {
            estimate: estimate.header.dimension.number(),
            reference: reference.header.dimension.number(),
        });
    }
    let matches = matches(estimate, reference);
    if matches.is_empty() && (relations.is_none() || reference.is_some()) {
        return Err(EvaluateError::NothingInCommon {
            estimate: estimate.nodes.len(),
            reference: reference.map_or(0, |reference| reference.nodes.len()),
            hint: if reference.is_some() {
                ""
            } else {
                ", or name --reference or --relations, because the estimate has no ground truth"
            },
        });
    }
    let freedom = options.align.unwrap_or(match estimate.header.dimension {
        Dimension::Two => Freedom::Se2,
        Dimension::Three => Freedom::Se3,
    });
    let groups = groups(&matches, options.scope);
    let mut found = BTreeMap::new();
    let (mut distances, mut angles) = (Vec::new(), Vec::new());
    let mut by_session: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (name, members) in &groups {
        let alignment = align(members, freedom);
        let (group_distances, group_angles) = errors(members, &alignment);
        for (member, distance) in members.iter().zip(&group_distances) {
            by_session.entry(member.session.clone()).or_default().push(*distance);
        }
        distances.extend(group_distances);
        angles.extend(group_angles);
        found.insert(name.clone(), describe(&alignment));
    }
    let translation_m = Summary::of(&distances);
    Ok(EvaluationResult {
        format: "posecut-result",
        version: 1,
        labels: labels(&options.labels)?,
        rmse: translation_m.map(|summary| summary.rmse),
        alignment: AlignmentUsed { freedom, scope: options.scope, found },
        components: components(estimate),
        poses: matches.len(),
        poses_unmatched: estimate.nodes.len() - matches.len(),
        ground_truth: reference
            .and_then(|reference| GroundTruth::of(estimate, reference, freedom, options.scope)),
        ate: AbsoluteError { translation_m, rotation_rad: Summary::of(&angles) },
        rpe: relative_error(&matches, options.rpe_delta as usize),
        relations,
        sessions: by_session
            .into_iter()
            .filter_map(|(name, errors)| Some((name, Summary::of(&errors)?)))
            .collect(),
        edges: score(estimate),
        calibration: calibration(estimate)?,
        doubts: estimate.header.doubts(),
        provenance: estimate.header.provenance.clone(),
    })
}

/// For each node, the first node (by index) of its connected component, over the edges in use that have a measurement.
fn first_of_component(graph: &PoseGraph) -> Vec<usize> {
    graph.first_of_part(|edge| edge.measurement.is_some())
}

fn components(graph: &PoseGraph) -> usize {
    first_of_component(graph).into_iter().enumerate().filter(|(node, first)| node == first).count()
}

/// Parses labels: a value that is a number becomes a number, any other becomes text.
fn labels(pairs: &[String]) -> Result<BTreeMap<String, Value>, EvaluateError> {
    pairs
        .iter()
        .map(|pair| {
            let refused = || EvaluateError::Label { label: pair.clone() };
            let (name, value) = pair.split_once('=').ok_or_else(refused)?;
            let value = value.parse::<u64>().map_or_else(|_| Value::from(value), Value::from);
            if name.is_empty() { Err(refused()) } else { Ok((name.to_owned(), value)) }
        })
        .collect()
}

/// Nodes that both graphs have, matched by session and frame.
fn matches(estimate: &PoseGraph, reference: Option<&PoseGraph>) -> Vec<Match> {
    pairs(estimate, reference.unwrap_or(estimate), |node| {
        let known = match reference {
            Some(reference) => reference.nodes.get(reference.node_index(node.id)?)?.pose.as_deref()?,
            None => node.truth.as_ref()?.pose.as_deref()?,
        };
        Some([node.pose.as_deref()?, known])
    })
}

/// A match for each node of the estimate for which there are two poses to compare. `components` is the graph whose components
/// matter.
pub(crate) fn pairs<'a>(
    estimate: &'a PoseGraph,
    components: &PoseGraph,
    poses: impl Fn(&'a Node) -> Option<[&'a [f64]; 2]>,
) -> Vec<Match> {
    let dimension = estimate.header.dimension;
    let first = first_of_component(components);
    let mut matches: Vec<Match> = estimate
        .nodes
        .iter()
        .filter_map(|node| {
            let [own, known] = poses(node)?;
            Some(Match {
                session: node.session.clone().unwrap_or_default(),
                frame: node.frame.unwrap_or(i64::try_from(node.id).unwrap_or(i64::MAX)),
                component: components.nodes[first[components.node_index(node.id)?]].id,
                estimate: dimension.spatial(own)?,
                reference: dimension.spatial(known)?,
            })
        })
        .collect();
    matches.sort_by(|first, second| (&first.session, first.frame).cmp(&(&second.session, second.frame)));
    matches
}

pub(crate) fn groups(matches: &[Match], scope: Scope) -> BTreeMap<String, Vec<&Match>> {
    let mut groups: BTreeMap<String, Vec<&Match>> = BTreeMap::new();
    for found in matches {
        let name = match scope {
            Scope::Joint => "all".to_owned(),
            Scope::PerSession => found.session.clone(),
            Scope::PerComponent => format!("node {}", found.component),
        };
        groups.entry(name).or_default().push(found);
    }
    groups
}

fn describe(alignment: &Alignment) -> AlignmentFound {
    AlignmentFound {
        rotation_vector: alignment.rotation.scaled_axis().into(),
        translation: alignment.translation.into(),
        scale: alignment.scale,
    }
}

//! Extracts a part of a pose graph that is itself a sound pose graph.

use std::str::FromStr;

use posecut_graph::{Edge, EdgeKind, Node, PoseGraph};
use serde::Serialize;

use crate::parts::parts;

/// What is kept: all that passes every option given. Ids, marks and unknown records stay as they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// Keep the nodes of this session (may be given several times); 2012-01-22 includes its experiences /a and /b
    #[arg(long, value_name = "NAME", help_heading = "Nodes")]
    pub session: Vec<String>,

    /// Keep the nodes with ids from FIRST to LAST; either bound may be omitted
    #[arg(long, value_name = "FIRST..LAST", help_heading = "Nodes")]
    pub nodes: Option<Range>,

    /// Keep the nodes with frames from FIRST to LAST
    #[arg(long, value_name = "FIRST..LAST", allow_hyphen_values = true, help_heading = "Nodes")]
    pub frames: Option<Range>,

    /// Keep the nodes with times from FIRST to LAST, microseconds UTC
    #[arg(long, value_name = "FIRST..LAST", allow_hyphen_values = true, help_heading = "Nodes")]
    pub times: Option<Range>,

    /// Keep the nodes of the N-th largest connected component of the edges in use, counted from 1
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), help_heading = "Nodes")]
    pub component: Option<u64>,

    /// Keep only the edges of this kind
    #[arg(long, value_enum, help_heading = "Edges")]
    pub kind: Option<Kind>,

    /// Keep only the landmark edges that are rejected, or only those in use
    #[arg(long, value_enum, help_heading = "Edges")]
    pub rejected: Option<Rejected>,

    /// Keep only the landmark edges with this label
    #[arg(long, value_enum, help_heading = "Edges")]
    pub truth: Option<Truth>,

    /// Remove the truth from nodes, edges and priors
    #[arg(long, help_heading = "Edges")]
    pub strip_truth: bool,
}

/// A kind of edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Odometry edges
    Odometry,
    /// Landmark edges (loop closures)
    Landmark,
}

/// Whether a landmark edge is rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Rejected {
    /// Rejected by some stage
    Yes,
    /// In use
    No,
}

/// What the truth says about a landmark edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Truth {
    /// The truth calls the edge correct
    Correct,
    /// The truth calls the edge incorrect
    Incorrect,
    /// The edge has no label
    Unknown,
}

/// A range of whole numbers, both ends included; either end may be open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Range {
    /// The smallest.
    pub first: Option<i128>,
    /// The largest.
    pub last: Option<i128>,
}

impl Range {
    fn contains(self, value: i128) -> bool {
        self.first.is_none_or(|first| first <= value) && self.last.is_none_or(|last| value <= last)
    }
}

impl FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected =
            || format!("\"{text}\" is not a range; use FIRST..LAST, FIRST.. or ..LAST (both ends included)");
        let (first, last) = text.split_once("..").ok_or_else(expected)?;
        let end = |text: &str| {
            // Ids and times fit into 64 bits; a number with more digits is a typing error.
            let number = |value: i128| (-(1 << 63)..=u64::MAX.into()).contains(&value).then_some(value);
            match text {
                "" => Ok(None),
                digits => digits.parse().ok().and_then(number).map(Some).ok_or_else(expected),
            }
        };
        let range = Self { first: end(first)?, last: end(last)? };
        if let (Some(first), Some(last)) = (range.first, range.last)
            && first > last
        {
            return Err(format!("the range {text} is empty; put the smaller number first"));
        }
        Ok(range)
    }
}

/// How much was left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Left {
    /// Number of nodes left out.
    pub nodes: usize,
    /// Number of edges left out by their own properties.
    pub edges: usize,
    /// Number of edges left out because one of their nodes was.
    pub edges_without_nodes: usize,
    /// Number of priors left out because their node was.
    #[serde(skip_serializing_if = "is_zero")]
    pub priors_without_nodes: usize,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Removes from a graph what the options do not keep. An edge or a prior is removed with its node, so that the rest is
/// sound.
/// O(size), with a logarithmic factor if ids do not count from 0.
pub fn filter(graph: &mut PoseGraph, options: &Options) -> Left {
    let mut kept: Vec<bool> = graph.nodes.iter().map(|node| options.keeps_node(node)).collect();
    if let Some(number) = options.component {
        let mut parts = parts(graph);
        // Largest first. The sort is stable: among components of the same size, the one with the smallest node comes
        // first.
        parts.sort_by_key(|part| std::cmp::Reverse(part.nodes.len()));
        let part = parts.get(number as usize - 1);
        let mut inside = vec![false; graph.nodes.len()];
        part.into_iter().flat_map(|part| &part.nodes).for_each(|&node| inside[node] = true);
        kept.iter_mut().zip(inside).for_each(|(kept, inside)| *kept &= inside);
    }
    let mut left = Left { nodes: kept.iter().filter(|kept| !**kept).count(), ..Left::default() };
    let mut edges = std::mem::take(&mut graph.edges);
    edges.retain(|edge| {
        let there = |id| graph.node_index(id).is_some_and(|index| kept[index]);
        let whole = there(edge.from) && there(edge.to);
        let wanted = options.keeps_edge(edge);
        left.edges_without_nodes += usize::from(!whole);
        left.edges += usize::from(whole && !wanted);
        whole && wanted
    });
    graph.edges = edges;
    let mut priors = std::mem::take(&mut graph.priors);
    priors.retain(|prior| {
        let there = graph.node_index(prior.node).is_some_and(|index| kept[index]);
        left.priors_without_nodes += usize::from(!there);
        there
    });
    graph.priors = priors;
    let mut place = kept.into_iter();
    graph.nodes.retain(|_| place.next().unwrap_or(true));
    if options.strip_truth {
        graph.nodes.iter_mut().for_each(|node| node.truth = None);
        graph.edges.iter_mut().for_each(|edge| edge.truth = None);
        graph.priors.iter_mut().for_each(|prior| prior.truth = None);
    }
    left
}

impl Options {
    fn keeps_node(&self, node: &Node) -> bool {
        let session = node.session.as_deref().unwrap_or_default();
        let named = |name: &String| {
            session.strip_prefix(name.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let within = |range: Option<Range>, value: Option<i64>| {
            range.is_none_or(|range| value.is_some_and(|value| range.contains(value.into())))
        };
        (self.session.is_empty() || self.session.iter().any(named))
            && self.nodes.is_none_or(|range| range.contains(node.id.into()))
            && within(self.frames, node.frame)
            && within(self.times, node.utime)
    }

    fn keeps_edge(&self, edge: &Edge) -> bool {
        let kind = match self.kind {
            None => true,
            Some(Kind::Odometry) => edge.kind == EdgeKind::Odometry,
            Some(Kind::Landmark) => edge.kind == EdgeKind::Landmark,
        };
        let rejected = match self.rejected {
            None => true,
            Some(Rejected::Yes) => !edge.in_use(),
            Some(Rejected::No) => edge.in_use(),
        };
        let truth = match self.truth {
            None => true,
            Some(Truth::Correct) => edge.truth_correct() == Some(true),
            Some(Truth::Incorrect) => edge.truth_correct() == Some(false),
            Some(Truth::Unknown) => edge.truth_correct().is_none(),
        };
        kind && (edge.kind == EdgeKind::Odometry || (rejected && truth))
    }
}

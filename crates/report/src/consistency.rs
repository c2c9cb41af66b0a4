//! The consistency matrix that PCM decided on, computed anew from a graph that went through it.

use std::collections::BTreeMap;

use anyhow::Context as _;
use posecut_graph::PoseGraph;
use posecut_pcm::calibration::Scales;
use posecut_pcm::replay::{GroupConsistency, consistency};
use posecut_pcm::{Gate, Options, Scale};
use posecut_stage::warn;
use serde_json::Value;

/// The name of the stage, in histories and marks.
const PCM: &str = "pcm";

/// PCM's candidates and which of them agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Places of the candidates among the graph's edges, ordered by group, then by their nodes.
    pub edges: Vec<usize>,
    /// The pair of chains that each joins.
    pub group: Vec<usize>,
    /// Whether each was kept: in the clique.
    pub clique: Vec<bool>,
    /// When a pair is consistent, in words.
    pub gate: String,
    consistent: Vec<bool>,
}

impl Matrix {
    /// Whether two candidates agree; every candidate agrees with itself.
    pub fn consistent(&self, one: usize, other: usize) -> bool {
        self.consistent[one * self.edges.len() + other]
    }

    /// Pairs that agree.
    pub fn pairs(&self) -> usize {
        (self.consistent.iter().filter(|consistent| **consistent).count() - self.edges.len()) / 2
    }
}

/// Whether a graph has been through PCM.
pub fn went_through_pcm(graph: &PoseGraph) -> bool {
    place_of_pcm(graph).is_some()
}

/// Where in the history of a graph PCM looked for a clique; re-admission, an option of pcm in earlier versions, looks at none.
fn place_of_pcm(graph: &PoseGraph) -> Option<usize> {
    let looks =
        |entry: &Value| stage(entry) == Some(PCM) && entry["arguments"]["readmit"] != Value::Bool(true);
    graph.header.provenance.iter().position(looks)
}

/// The matrix of a graph that went through PCM, by the options in its history; marks of PCM and later stages are
/// taken back first. `None` if it did not. O(candidates^2).
pub fn matrix(graph: &PoseGraph) -> anyhow::Result<Option<Matrix>> {
    let Some(place) = place_of_pcm(graph) else {
        return Ok(None);
    };
    let earlier: Vec<&str> = graph.header.provenance[..place].iter().filter_map(stage).collect();
    let mut before = graph.clone();
    for edge in &mut before.edges {
        if edge.rejected_by.as_deref().is_some_and(|stage| !earlier.contains(&stage)) {
            edge.readmit();
        }
    }
    let options = options(&graph.header.provenance[place]["arguments"])?;
    let replay = consistency(&options, &before)?;
    if let Some(warning) = &replay.warning {
        warn!("{warning}");
    }
    Ok(Some(of(graph, &replay.groups)))
}

fn stage(entry: &Value) -> Option<&str> {
    entry.get("stage")?.as_str()
}

/// The options that the graph was decided on with, for the informations that it has now.
fn options(arguments: &Value) -> anyhow::Result<Options> {
    let mut options: Options = serde_json::from_value(arguments.clone()).with_context(|| {
        format!("the history's arguments of pcm are none that this version knows: {arguments}")
    })?;
    if options.calibrate {
        // Informations are divided by what was estimated, and an estimate would divide them again.
        anyhow::ensure!(
            options.scale == Scale::Auto,
            "pcm divided informations by one scale (--calibrate) and tested with another (--scale {}), so its consistency \
             cannot be told from the graph; call it with --scale auto",
            options.scale
        );
        options.calibrate = false;
        options.scale = Scale::Fixed(Scales::ONE);
    }
    Ok(options)
}

fn of(graph: &PoseGraph, groups: &[GroupConsistency]) -> Matrix {
    let count = groups.iter().map(|group| group.places.len()).sum();
    let mut matrix = Matrix {
        edges: Vec::with_capacity(count),
        group: Vec::with_capacity(count),
        clique: Vec::with_capacity(count),
        gate: in_words(groups),
        consistent: vec![false; count * count],
    };
    for (number, group) in groups.iter().enumerate() {
        let start = matrix.edges.len();
        // Along the first chain, then the second.
        let mut order: Vec<usize> = (0..group.places.len()).collect();
        order.sort_by_key(|&vertex| group.places[vertex]);
        for (row, &one) in order.iter().enumerate() {
            let (_, _, edge) = group.places[one];
            matrix.edges.push(edge);
            matrix.group.push(number);
            matrix.clique.push(graph.edges[edge].rejected_by.as_deref() != Some(PCM));
            for (column, &other) in order.iter().enumerate() {
                matrix.consistent[(start + row) * count + start + column] =
                    row == column || group.agree(one, other);
            }
        }
    }
    matrix
}

/// The gates of all groups, which differ where they are corrected for the number of pairs.
fn in_words(groups: &[GroupConsistency]) -> String {
    let gates: Vec<Gate> = groups.iter().map(|group| group.gate).collect();
    if let Some(Gate { per_step: Some(per_step), .. }) = gates.first() {
        return format!("{} m and {} rad a step", per_step.translation, per_step.rotation);
    }
    let least = gates.iter().map(|gate| gate.squared_distance).fold(f64::INFINITY, f64::min);
    let most = gates.iter().map(|gate| gate.squared_distance).fold(f64::NEG_INFINITY, f64::max);
    if least < most { format!("{least:.2} to {most:.2}") } else { format!("{least:.2}") }
}

/// The order in which a matrix is drawn: within each group the clique first, then the others by how many of
/// the clique they agree with, so that blocks stand out.
pub fn clique_first(matrix: &Matrix) -> Vec<usize> {
    let count = matrix.edges.len();
    let agreeing: BTreeMap<usize, usize> = (0..count)
        .map(|row| {
            let agreeing =
                (0..count).filter(|&column| matrix.clique[column] && matrix.consistent(row, column)).count();
            (row, agreeing)
        })
        .collect();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&row| {
        let inside = matrix.clique[row];
        (matrix.group[row], !inside, if inside { 0 } else { count - agreeing[&row] }, row)
    });
    order
}

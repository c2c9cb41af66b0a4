//! The consistency matrix of PCM, computed again from a graph that PCM processed.

use std::collections::BTreeMap;

use anyhow::Context as _;
use posecut_graph::PoseGraph;
use posecut_pcm::calibration::Scales;
use posecut_pcm::replay::{GroupConsistency, consistency};
use posecut_pcm::{Gate, Options, Scale};
use posecut_stage::warn;
use serde_json::Value;

/// The name of the stage in histories and marks.
const PCM: &str = "pcm";

/// PCM's candidates and which of them agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Indices of the candidates among the graph's edges, ordered by group, then by their nodes.
    pub edges: Vec<usize>,
    /// The group of each candidate: one group for each pair of chains.
    pub group: Vec<usize>,
    /// Whether PCM kept each candidate, that is, whether it is in the clique.
    pub clique: Vec<bool>,
    /// The condition for a consistent pair, in words.
    pub gate: String,
    consistent: Vec<bool>,
}

impl Matrix {
    /// Whether two candidates agree; every candidate agrees with itself.
    pub fn consistent(&self, one: usize, other: usize) -> bool {
        self.consistent[one * self.edges.len() + other]
    }

    /// Number of consistent pairs.
    pub fn pairs(&self) -> usize {
        (self.consistent.iter().filter(|consistent| **consistent).count() - self.edges.len()) / 2
    }
}

/// Whether PCM processed a graph.
pub fn went_through_pcm(graph: &PoseGraph) -> bool {
    place_of_pcm(graph).is_some()
}

/// The position in a graph's history where PCM looked for a clique. Re-admission, an option of pcm in earlier versions,
/// looks for none and does not count.
fn place_of_pcm(graph: &PoseGraph) -> Option<usize> {
    let looks =
        |entry: &Value| stage(entry) == Some(PCM) && entry["arguments"]["readmit"] != Value::Bool(true);
    graph.header.provenance.iter().position(looks)
}

/// The matrix of a graph that PCM processed, by the options in its history; `None` if PCM did not. The marks of PCM and
/// later stages are removed first. O(candidates^2).
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

/// The options of the recorded run of PCM, adapted to the information matrices that the graph has now.
fn options(arguments: &Value) -> anyhow::Result<Options> {
    let mut options: Options = serde_json::from_value(arguments.clone()).with_context(|| {
        format!("this version does not know the arguments of pcm in the graph's history: {arguments}")
    })?;
    if options.calibrate {
        // PCM has divided the information matrices by the estimated scales; a second estimate would divide them again.
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
        // Sort along the first chain, then along the second.
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

/// The gates in words: a range if they differ between groups, because of the correction for the number of pairs.
fn in_words(groups: &[GroupConsistency]) -> String {
    let gates: Vec<Gate> = groups.iter().map(|group| group.gate).collect();
    if let Some(Gate { per_step: Some(per_step), .. }) = gates.first() {
        return format!("{} m and {} rad per step", per_step.translation, per_step.rotation);
    }
    let least = gates.iter().map(|gate| gate.squared_distance).fold(f64::INFINITY, f64::min);
    let most = gates.iter().map(|gate| gate.squared_distance).fold(f64::NEG_INFINITY, f64::max);
    if least < most { format!("{least:.2} to {most:.2}") } else { format!("{least:.2}") }
}

/// The order in which a matrix is drawn. Within each group the clique comes first, then the others by the number of
/// clique members that they agree with, so that blocks are visible.
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

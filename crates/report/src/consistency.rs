//! The consistency matrix that PCM decided on, computed anew from a graph that went through it.

use std::collections::BTreeMap;

use anyhow::Context as _;
use clap::ValueEnum as _;
use posecut_geometry::{SE2, SE3};
use posecut_graph::{Dimension, PoseGraph};
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::consistency::consistency_graph;
use posecut_pcm::{Gate, Spatial, Test};
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
    /// The largest squared Mahalanobis distance of a consistent pair.
    pub gate: f64,
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
    graph.header.provenance.iter().any(|entry| stage(entry) == Some(PCM))
}

/// The matrix of a graph that went through PCM, with the gate of its history; marks of PCM and later stages are
/// taken back first. `None` if it did not. O(candidates^2).
pub fn matrix(graph: &PoseGraph) -> anyhow::Result<Option<Matrix>> {
    let Some(place) = graph.header.provenance.iter().position(|entry| stage(entry) == Some(PCM)) else {
        return Ok(None);
    };
    let earlier: Vec<&str> = graph.header.provenance[..place].iter().filter_map(stage).collect();
    let mut before = graph.clone();
    for edge in &mut before.edges {
        if edge.rejected_by.as_deref().is_some_and(|stage| !earlier.contains(&stage)) {
            edge.rejected_by = None;
        }
    }
    let arguments = &graph.header.provenance[place]["arguments"];
    let degrees = match graph.header.dimension {
        Dimension::Two => 3,
        Dimension::Three => 6,
    };
    let gate = gate(arguments, degrees)?;
    let matrix = match graph.header.dimension {
        Dimension::Two => of::<SE2, 3>(&before, gate)?,
        Dimension::Three => of::<SE3, 6>(&before, gate)?,
    };
    Ok(Some(marked(graph, matrix)))
}

fn stage(entry: &Value) -> Option<&str> {
    entry.get("stage")?.as_str()
}

fn gate(arguments: &Value, degrees: usize) -> anyhow::Result<Gate> {
    let said = || format!("the history's arguments of pcm do not tell its gate: {arguments}");
    let test = arguments.get("test").and_then(Value::as_str).with_context(said)?;
    let test = Test::from_str(test, false).map_err(anyhow::Error::msg).with_context(said)?;
    let probability = arguments.get("probability").and_then(Value::as_f64).with_context(said)?;
    Ok(Gate::new(test, probability, degrees)?)
}

fn of<G: Spatial<DOF>, const DOF: usize>(graph: &PoseGraph, gate: Gate) -> anyhow::Result<Matrix> {
    let chains = Chains::<G, DOF>::of(graph)?;
    let grouped = group(graph, &chains)?;
    let count = grouped.groups.iter().map(|group| group.candidates.len()).sum();
    let mut matrix = Matrix {
        edges: Vec::with_capacity(count),
        group: Vec::with_capacity(count),
        clique: Vec::new(),
        gate: gate.squared_distance,
        consistent: vec![false; count * count],
    };
    for (number, group) in grouped.groups.iter().enumerate() {
        let start = matrix.edges.len();
        let consistency = consistency_graph(&chains, group, gate);
        // Along the first chain, then the second.
        let mut order: Vec<usize> = (0..group.candidates.len()).collect();
        order.sort_by_key(|&vertex| {
            let candidate = &group.candidates[vertex];
            (candidate.i, candidate.k, candidate.edge)
        });
        for (row, &one) in order.iter().enumerate() {
            matrix.edges.push(group.candidates[one].edge);
            matrix.group.push(number);
            for (column, &other) in order.iter().enumerate() {
                matrix.consistent[(start + row) * count + start + column] =
                    row == column || consistency.graph.connected(one, other);
            }
        }
    }
    Ok(matrix)
}

fn marked(graph: &PoseGraph, mut matrix: Matrix) -> Matrix {
    matrix.clique =
        matrix.edges.iter().map(|&edge| graph.edges[edge].rejected_by.as_deref() != Some(PCM)).collect();
    matrix
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

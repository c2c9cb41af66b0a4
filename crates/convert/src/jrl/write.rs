//! Writes JRL datasets.

mod keys;

use std::collections::BTreeMap;

use posecut_graph::{Dimension, Edge, EdgeKind, Node, PoseGraph, Prior, PriorOf};
use serde::Serialize;
use serde_json::{Value, json};

use super::covariance::covariance;
use crate::ConvertError;
use keys::Keys;

/// The variance of the prior that fixes a node: 0.1 mm and 0.1 mrad.
const FIXED_VARIANCE: f64 = 1e-8;

/// What the writer left out or renamed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WriteSummary {
    /// Edges left out because a stage has rejected them.
    pub rejected: usize,
    /// Edges left out because they have no measurement.
    pub unmeasured: usize,
    /// Landmark edges without a label, which is why the labels of all others are left out.
    pub unlabelled: usize,
    /// The robots whose letter is not the name of their session.
    pub renamed: Vec<(char, String)>,
    /// Priors left out because a stage has rejected them.
    pub rejected_priors: usize,
    /// Priors of positions, left out because the format has none.
    pub positions: usize,
    /// Priors on the first pose of a robot, which are read as anchors.
    pub anchors: usize,
}

#[derive(Serialize)]
struct Dataset<'a> {
    name: &'a str,
    /// The codes of the letters, as the format's own library writes and reads them.
    robots: Vec<u32>,
    measurements: BTreeMap<char, Vec<Entry>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    groundtruth: Option<BTreeMap<char, Vec<Value>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    initialization: Option<BTreeMap<char, Vec<Value>>>,
    potential_outlier_factors: BTreeMap<char, Vec<(usize, usize)>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    outlier_factors: Option<BTreeMap<char, Vec<(usize, usize)>>>,
}

#[derive(Serialize)]
struct Entry {
    stamp: u64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    measurements: Vec<Value>,
}

/// Writes a dataset: one robot for each session, an entry for each node, edges in use (all edges with `keep_rejected`) as
/// `BetweenFactor`, landmark edges as potential outliers, and labels if all landmark edges have one. It is an error if an information
/// matrix is singular, because the format holds covariances.
pub fn write(graph: &PoseGraph, keep_rejected: bool) -> Result<(Vec<u8>, WriteSummary), ConvertError> {
    let keys = Keys::of(graph)?;
    let mut summary = WriteSummary { renamed: keys.renamed.clone(), ..WriteSummary::default() };
    let mut writer = Writer::new(graph, &keys)?;
    for edge in &graph.edges {
        if !edge.in_use() && !keep_rejected {
            summary.rejected += 1;
        } else if edge.measurement.is_none() {
            summary.unmeasured += 1;
        } else {
            writer.edge(edge)?;
        }
    }
    for prior in &graph.priors {
        if !prior.in_use() && !keep_rejected {
            summary.rejected_priors += 1;
        } else if prior.of(graph.header.dimension) == Some(PriorOf::Pose) {
            summary.anchors += usize::from(writer.prior(prior)?);
        } else {
            summary.positions += 1;
        }
    }
    summary.unlabelled = if writer.labelled > 0 { writer.unlabelled } else { 0 };
    let labelled = writer.labelled > 0 && writer.unlabelled == 0;
    let name = graph.header.extra.get(super::NAME).and_then(Value::as_str);
    let dataset = Dataset {
        name: name.unwrap_or("posecut"),
        robots: keys.letters.iter().map(|&letter| u32::from(letter)).collect(),
        groundtruth: writer.values(|node| node.truth.as_ref()?.pose.as_deref()),
        initialization: writer.values(|node| node.pose.as_deref()),
        measurements: writer.entries,
        potential_outlier_factors: writer.potential,
        outlier_factors: labelled.then_some(writer.outliers),
    };
    let mut bytes = serde_json::to_vec(&dataset).map_err(|error| {
        ConvertError::graph(format!("the dataset cannot be written as JSON: {error}"), "write g2o")
    })?;
    bytes.push(b'\n');
    Ok((bytes, summary))
}

struct Writer<'a> {
    graph: &'a PoseGraph,
    keys: &'a Keys,
    entries: BTreeMap<char, Vec<Entry>>,
    potential: BTreeMap<char, Vec<(usize, usize)>>,
    outliers: BTreeMap<char, Vec<(usize, usize)>>,
    /// For each robot the nodes that its measurements name.
    observed: BTreeMap<char, Vec<usize>>,
    labelled: usize,
    unlabelled: usize,
}

impl<'a> Writer<'a> {
    /// Starts with the entries and the priors.
    fn new(graph: &'a PoseGraph, keys: &'a Keys) -> Result<Self, ConvertError> {
        let lists = || keys.letters.iter().map(|&letter| (letter, Vec::new())).collect();
        let mut entries: BTreeMap<char, Vec<Entry>> =
            keys.letters.iter().map(|&letter| (letter, Vec::new())).collect();
        let mut observed: BTreeMap<char, Vec<usize>> =
            keys.letters.iter().map(|&letter| (letter, Vec::new())).collect();
        let stamps = keys::stamps(graph, keys);
        for &index in &keys.order {
            let (node, key) = (&graph.nodes[index], &keys.nodes[index]);
            let mut measurements = Vec::new();
            let fixed = node.is_fixed().map_err(|value| {
                ConvertError::graph(
                    format!("node {}: the field \"fixed\" is {value}", node.id),
                    "set it to true or false",
                )
            })?;
            if let Some(pose) = node.pose.as_deref().filter(|_| fixed) {
                measurements.push(anchor(key.key(), graph.header.dimension, pose));
            }
            observed.entry(key.letter).or_default().push(index);
            entries.entry(key.letter).or_default().push(Entry { stamp: stamps[index], measurements });
        }
        Ok(Self {
            graph,
            keys,
            entries,
            potential: lists(),
            outliers: lists(),
            observed,
            labelled: 0,
            unlabelled: 0,
        })
    }

    fn edge(&mut self, edge: &Edge) -> Result<(), ConvertError> {
        let dimension = self.graph.header.dimension;
        let index = |id: u64| {
            self.graph.node_index(id).ok_or_else(|| {
                ConvertError::graph(format!("{}: there is no node {id}", edge.name()), "add the node")
            })
        };
        let (from, to) = (index(edge.from)?, index(edge.to)?);
        let (first, second) = (&self.keys.nodes[from], &self.keys.nodes[to]);
        let packed = self.graph.information(edge).unwrap_or_default();
        let covariance = self.covariance_of(&edge.name(), packed)?;
        // An edge between two robots belongs to the first. Within a robot it is measured when the later pose is known.
        let (owner, entry) = if first.letter == second.letter {
            (first.letter, first.entry.max(second.entry))
        } else {
            self.observed.entry(first.letter).or_default().push(to);
            (first.letter, first.entry)
        };
        let number = dimension.number();
        let factor = json!({
            "type": format!("BetweenFactorPose{number}"),
            "key1": first.key(),
            "key2": second.key(),
            "measurement": pose(dimension, edge.measurement.as_deref().unwrap_or_default()),
            "covariance": covariance,
        });
        let Some(place) = self.entries.get_mut(&owner).and_then(|entries| entries.get_mut(entry)) else {
            return Ok(());
        };
        let id = (entry, place.measurements.len());
        place.measurements.push(factor);
        if edge.kind == EdgeKind::Landmark {
            self.potential.entry(owner).or_default().push(id);
            match edge.truth_correct() {
                Some(correct) => {
                    self.labelled += 1;
                    if !correct {
                        self.outliers.entry(owner).or_default().push(id);
                    }
                }
                None => self.unlabelled += 1,
            }
        }
        Ok(())
    }

    /// Writes the prior of a pose into the entry of its node. Returns whether that is the first pose of a robot.
    fn prior(&mut self, prior: &Prior) -> Result<bool, ConvertError> {
        let dimension = self.graph.header.dimension;
        let index = self.graph.node_index(prior.node).ok_or_else(|| {
            ConvertError::graph(format!("{}: there is no node {}", prior.name(), prior.node), "add the node")
        })?;
        let key = &self.keys.nodes[index];
        let packed = self.graph.information_of_prior(prior).unwrap_or_default();
        let covariance = self.covariance_of(&prior.name(), packed)?;
        let entry = self.entries.get_mut(&key.letter).and_then(|entries| entries.get_mut(key.entry));
        if let Some(entry) = entry {
            entry.measurements.push(prior_factor(key.key(), dimension, &prior.measurement, &covariance));
        }
        let first = self.observed.get(&key.letter).and_then(|observed| observed.first());
        Ok(first == Some(&index))
    }

    /// The covariance of an information matrix of the record with this name.
    fn covariance_of(&self, name: &str, packed: &[f64]) -> Result<Vec<f64>, ConvertError> {
        covariance(self.graph.header.dimension, packed).map_err(|problem| {
            // Without the remedy that follows the problem: there is a better one here.
            let problem = problem.split("; ").next().unwrap_or_default();
            ConvertError::graph(
                format!("{name}: the information matrix has no covariance: {problem}"),
                "JRL holds covariances; write g2o, which holds information matrices",
            )
        })
    }

    /// Poses of all nodes that a robot's measurements name; `None` if no node has one.
    fn values(&self, of: impl Fn(&Node) -> Option<&[f64]>) -> Option<BTreeMap<char, Vec<Value>>> {
        let dimension = self.graph.header.dimension;
        let mut any = false;
        let mut values = BTreeMap::new();
        for (&letter, observed) in &self.observed {
            let mut nodes = observed.clone();
            nodes.sort_unstable_by_key(|&index| self.keys.nodes[index].key());
            nodes.dedup();
            let list: Vec<Value> = nodes
                .into_iter()
                .filter_map(|index| {
                    let mut value = pose(dimension, of(&self.graph.nodes[index])?);
                    value["key"] = self.keys.nodes[index].key().into();
                    Some(value)
                })
                .collect();
            any |= !list.is_empty();
            values.insert(letter, list);
        }
        any.then_some(values)
    }
}

/// The prior of a fixed node.
fn anchor(key: u64, dimension: Dimension, at: &[f64]) -> Value {
    let side = dimension.degrees_of_freedom();
    let variance = |place: usize| if place.is_multiple_of(side + 1) { FIXED_VARIANCE } else { 0.0 };
    prior_factor(key, dimension, at, &(0..side * side).map(variance).collect::<Vec<f64>>())
}

fn prior_factor(key: u64, dimension: Dimension, at: &[f64], covariance: &[f64]) -> Value {
    let number = dimension.number();
    json!({
        "type": format!("PriorFactorPose{number}"),
        "key": key,
        "prior": pose(dimension, at),
        "covariance": covariance,
    })
}

/// A pose as JRL has it: quaternions begin with w.
fn pose(dimension: Dimension, components: &[f64]) -> Value {
    match (dimension, components) {
        (Dimension::Two, &[x, y, theta]) => json!({"type": "Pose2", "x": x, "y": y, "theta": theta}),
        (Dimension::Three, &[x, y, z, qx, qy, qz, qw]) => {
            json!({"type": "Pose3", "translation": [x, y, z], "rotation": [qw, qx, qy, qz]})
        }
        // Graphs have been checked: there is no other pose.
        _ => Value::Null,
    }
}

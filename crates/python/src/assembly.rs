//! Graphs from arrays. Each is checked as a file would be.

use anyhow::{bail, ensure};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, PoseGraph};
use posecut_stage::counted;
use pyo3::prelude::*;
use serde_json::{Map, Value};

use crate::graph::Graph;
use crate::work;

/// What messages call a graph that no file holds.
const NAME: &str = "arrays";

/// A table of numbers, by rows.
pub(crate) struct Rows {
    values: Vec<f64>,
    width: usize,
}

impl Rows {
    /// A copy of an array.
    pub(crate) fn of(array: &PyReadonlyArray2<'_, f64>) -> Self {
        let array = array.as_array();
        Self { values: array.iter().copied().collect(), width: array.ncols() }
    }

    fn count(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }

    /// A row; `None` if it is NaN throughout.
    fn row(&self, index: usize) -> Option<Vec<f64>> {
        let row = &self.values[index * self.width..(index + 1) * self.width];
        (!row.iter().all(|value| value.is_nan())).then(|| row.to_vec())
    }
}

/// Nodes and edges, as arrays hold them.
struct Arrays {
    poses: Rows,
    ends: Vec<[i64; 2]>,
    measurements: Rows,
    information: Vec<f64>,
    side: usize,
    landmark: Vec<bool>,
    ids: Option<Vec<u64>>,
    edge_ids: Option<Vec<u64>>,
    /// Further fields by name, each a JSON array with a value for each record.
    node_fields: String,
    edge_fields: String,
}

/// A graph of arrays (posecut.Graph.from_arrays).
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "Python passes them by name")]
pub(crate) fn from_arrays(
    py: Python<'_>,
    poses: PyReadonlyArray2<'_, f64>,
    ends: PyReadonlyArray2<'_, i64>,
    measurements: PyReadonlyArray2<'_, f64>,
    information: PyReadonlyArray3<'_, f64>,
    landmark: PyReadonlyArray1<'_, bool>,
    ids: Option<Vec<u64>>,
    edge_ids: Option<Vec<u64>>,
    node_fields: String,
    edge_fields: String,
) -> PyResult<Graph> {
    let ends = ends.as_array();
    let arrays = Arrays {
        poses: Rows::of(&poses),
        ends: ends.rows().into_iter().map(|row| [row[0], row[1]]).collect(),
        measurements: Rows::of(&measurements),
        side: information.as_array().shape()[1],
        information: information.as_array().iter().copied().collect(),
        landmark: landmark.as_array().to_vec(),
        ids,
        edge_ids,
        node_fields,
        edge_fields,
    };
    work::run(py, move || arrays.graph())
}

impl Arrays {
    fn graph(self) -> anyhow::Result<Graph> {
        let dimension = match self.poses.width {
            3 => Dimension::Two,
            7 => Dimension::Three,
            width => bail!(
                "poses have {}; give (N, 3) for x, y, theta, or (N, 7) for x, y, z, qx, qy, qz, qw",
                counted(width, "column")
            ),
        };
        let (nodes, edges) = (self.poses.count(), self.ends.len());
        let side = dimension.degrees_of_freedom();
        ensure!(
            self.measurements.width == self.poses.width || edges == 0,
            "measurements have {}, but poses {}; give both the same",
            counted(self.measurements.width, "column"),
            self.poses.width
        );
        ensure!(
            self.side == side || edges == 0,
            "information matrices are {0} by {0}, but this graph of dimension {dimension} needs {side} by {side}",
            self.side
        );
        for (name, count, needed) in [
            ("measurements", self.measurements.count(), edges),
            ("information", self.information.len().checked_div(side * side).unwrap_or(0), edges),
            ("landmark", self.landmark.len(), edges),
            ("edge_ids", self.edge_ids.as_ref().map_or(edges, Vec::len), edges),
            ("ids", self.ids.as_ref().map_or(nodes, Vec::len), nodes),
        ] {
            ensure!(
                count == needed,
                "{name} has {}, but {needed} are needed",
                counted(count, "entry").replace("entrys", "entries")
            );
        }
        let mut graph = PoseGraph::new(Header::new(dimension));
        for index in 0..nodes {
            let id = self.ids.as_ref().map_or(index as u64, |ids| ids[index]);
            graph.nodes.push(Node { id, pose: self.poses.row(index), ..Node::default() });
        }
        for index in 0..edges {
            let edge = self.edge(index, &graph.nodes)?;
            graph.edges.push(edge);
        }
        set_fields(&self.node_fields, "node_fields", graph.nodes.iter_mut().map(|node| &mut node.extra))?;
        set_fields(&self.edge_fields, "edge_fields", graph.edges.iter_mut().map(|edge| &mut edge.extra))?;
        checked(&graph)
    }

    fn edge(&self, index: usize, nodes: &[Node]) -> anyhow::Result<Edge> {
        let id = self.edge_ids.as_ref().map_or(index as u64, |ids| ids[index]);
        let node = |row: i64| match usize::try_from(row).ok().and_then(|row| nodes.get(row)) {
            Some(node) => Ok(node.id),
            None => bail!(
                "ends, row {index}: there is no pose in row {row}; ends are row numbers of poses, from 0 to {}",
                nodes.len().saturating_sub(1)
            ),
        };
        let [from, to] = self.ends[index];
        let kind = if self.landmark[index] { EdgeKind::Landmark } else { EdgeKind::Odometry };
        let mut edge = Edge::new(kind, id, node(from)?, node(to)?);
        edge.measurement = self.measurements.row(index);
        edge.information = self.upper(index)?;
        Ok(edge)
    }

    /// The upper triangle of the information matrix of an edge; `None` if it is NaN throughout.
    fn upper(&self, index: usize) -> anyhow::Result<Option<Vec<f64>>> {
        let side = self.side;
        let matrix = &self.information[index * side * side..(index + 1) * side * side];
        if matrix.iter().all(|term| term.is_nan()) {
            return Ok(None);
        }
        let scale = matrix.iter().fold(0.0, |largest: f64, term| largest.max(term.abs()));
        let mut upper = Vec::with_capacity(side * (side + 1) / 2);
        for row in 0..side {
            for column in row..side {
                let (above, below) = (matrix[row * side + column], matrix[column * side + row]);
                ensure!(
                    !((above - below).abs() > 1e-9 * scale),
                    "information, row {index}: the matrix is not symmetric (terms {row}, {column} are {above} and {below}); give the \
                     inverse of a covariance matrix"
                );
                upper.push(above);
            }
        }
        Ok(Some(upper))
    }
}

/// Sets fields of records from JSON. `null` leaves a field out.
fn set_fields<'a>(
    json: &str,
    argument: &str,
    records: impl ExactSizeIterator<Item = &'a mut Map<String, Value>>,
) -> anyhow::Result<()> {
    let fields: Map<String, Value> = serde_json::from_str(json)?;
    let count = records.len();
    let mut columns = Vec::with_capacity(fields.len());
    for (name, values) in fields {
        let Value::Array(values) = values else {
            bail!("{argument}: {name} is not a sequence; give one value for each")
        };
        ensure!(
            values.len() == count,
            "{argument}: {name} has {} values, but {count} are needed",
            values.len()
        );
        columns.push((name, values.into_iter()));
    }
    for record in records {
        for (name, values) in &mut columns {
            if let Some(value) = values.next().filter(|value| !value.is_null()) {
                record.insert(name.clone(), value);
            }
        }
    }
    Ok(())
}

/// A graph with other poses.
pub(crate) fn with_poses(mut graph: PoseGraph, poses: &Rows) -> anyhow::Result<Graph> {
    let width = graph.header.dimension.pose_components();
    ensure!(
        poses.width == width && poses.count() == graph.nodes.len(),
        "poses have the shape ({}, {}), but this graph needs ({}, {width})",
        poses.count(),
        poses.width,
        graph.nodes.len()
    );
    for (index, node) in graph.nodes.iter_mut().enumerate() {
        node.pose = poses.row(index);
    }
    checked(&graph)
}

/// The graph as a file would give it back: sorted, with every field checked.
fn checked(graph: &PoseGraph) -> anyhow::Result<Graph> {
    let mut bytes = Vec::new();
    graph.write(&mut bytes)?;
    let graph = PoseGraph::read(NAME, bytes.as_slice())?;
    let mut canonical = Vec::new();
    graph.write(&mut canonical)?;
    Ok(Graph::new(graph, Some(posecut_stage::digest(&canonical))))
}

//! A graph as Python holds it. It never changes.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use posecut_graph::{Edge, InputDigest, PoseGraph};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{self, Table};
use crate::columns::{self, Of};
use crate::error::Error;
use crate::messages::Messages;
use crate::stages::Stage;
use crate::{assembly, files, work};

/// Statistics as JSON, names of doubts, and messages by kind.
pub(crate) type Said = (String, Vec<&'static str>, Vec<(&'static str, String)>);

/// What a call reports besides its result.
pub(crate) fn said(statistics: String, doubts: Vec<&'static str>, messages: Messages) -> Said {
    (statistics, doubts, messages.into_iter().map(|(kind, text)| (kind.name(), text)).collect())
}

/// A pose graph in memory.
#[pyclass(frozen, module = "posecut._posecut")]
pub(crate) struct Graph {
    graph: Arc<PoseGraph>,
    /// SHA-256 of the file that holds the graph: of the one that was read, or of the one that would be written.
    digest: Arc<OnceLock<String>>,
}

impl Graph {
    /// A graph; `digest` is that of the file it was read from.
    pub(crate) fn new(graph: PoseGraph, digest: Option<String>) -> Self {
        Self { graph: Arc::new(graph), digest: Arc::new(digest.map_or_else(OnceLock::new, OnceLock::from)) }
    }
}

/// The digest of a graph, as a stage of a pipe would compute it.
fn digest_of(graph: &PoseGraph, known: &OnceLock<String>) -> anyhow::Result<String> {
    if let Some(digest) = known.get() {
        return Ok(digest.clone());
    }
    let mut bytes = Vec::new();
    graph.write(&mut bytes)?;
    Ok(known.get_or_init(|| posecut_stage::digest(&bytes)).clone())
}

#[pymethods]
impl Graph {
    /// 2 or 3.
    #[getter]
    fn dimension(&self) -> u64 {
        self.graph.header.dimension.number()
    }

    /// The number of nodes.
    #[getter]
    fn node_count(&self) -> usize {
        self.graph.nodes.len()
    }

    /// The number of edges.
    #[getter]
    fn edge_count(&self) -> usize {
        self.graph.edges.len()
    }

    /// What each stage did, as JSON.
    fn provenance(&self) -> PyResult<String> {
        serde_json::to_string(&self.graph.header.provenance)
            .map_err(|error| Error::new_err(error.to_string()))
    }

    /// A table of numbers: poses, truth, measurements or information.
    fn table<'py>(&self, py: Python<'py>, which: &str) -> PyResult<Bound<'py, PyAny>> {
        let table = Table::named(which)?;
        let graph = Arc::clone(&self.graph);
        let (values, shape) = py.detach(move || table.of(&graph));
        arrays::numbers(py, values, shape)
    }

    /// For each edge the rows of its nodes in the table of poses.
    fn ends<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::ends(py, &self.graph)
    }

    /// A flag for each edge or node: landmark, rejected or fixed.
    fn flags<'py>(&self, py: Python<'py>, which: &str) -> PyResult<Bound<'py, PyAny>> {
        arrays::flags(py, &self.graph, which)
    }

    /// The names of the fields that nodes or edges have.
    fn column_names(&self, of: &str) -> PyResult<Vec<String>> {
        Ok(columns::names(&self.graph, Of::named(of)?))
    }

    /// A field of all nodes or edges; `None` if none has it.
    fn column<'py>(&self, py: Python<'py>, of: &str, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        columns::column(py, &self.graph, Of::named(of)?, name)
    }

    /// Runs a stage. Returns the new graph, and statistics, doubts and messages.
    fn run(&self, py: Python<'_>, stage: &str, words: Vec<String>) -> PyResult<(Self, Said)> {
        let stage = Stage::named(stage)?;
        let (graph, digest) = (Arc::clone(&self.graph), Arc::clone(&self.digest));
        let finished = work::compute(py, move || {
            let input = InputDigest { name: "graph".to_owned(), sha256: digest_of(&graph, &digest)? };
            stage.run(PoseGraph::clone(&graph), &words, input)
        })?;
        let said = said(finished.statistics, finished.doubts, finished.messages);
        Ok((Self::new(finished.graph, None), said))
    }

    /// Compares with a reference, or with the graph's own truth. Returns the result as JSON.
    fn evaluate(&self, py: Python<'_>, reference: Option<&Self>, words: Vec<String>) -> PyResult<String> {
        let graph = Arc::clone(&self.graph);
        let reference = reference.map(|reference| Arc::clone(&reference.graph));
        work::compute(py, move || {
            let options: posecut_evaluate::Options = crate::error::parse("evaluate", &words)?;
            let result = posecut_evaluate::evaluate(&graph, reference.as_deref(), &options)?;
            Ok(serde_json::to_string(&result)?)
        })
    }

    /// Writes the graph to a file. Returns the messages.
    fn write(&self, py: Python<'_>, path: PathBuf, words: Vec<String>) -> PyResult<Said> {
        let graph = Arc::clone(&self.graph);
        let messages = work::run(py, move || files::write(&graph, &path, &words))?;
        Ok(said("{}".to_owned(), Vec::new(), messages))
    }

    /// The bytes of a file with the graph.
    fn to_bytes<'py>(&self, py: Python<'py>, words: Vec<String>) -> PyResult<(Bound<'py, PyBytes>, Said)> {
        let graph = Arc::clone(&self.graph);
        let (bytes, messages) = work::run(py, move || files::bytes(&graph, &words))?;
        Ok((PyBytes::new(py, &bytes), said("{}".to_owned(), Vec::new(), messages)))
    }

    /// The graph with other poses. A row of NaN is a node without a pose.
    fn with_poses(&self, py: Python<'_>, poses: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        let poses = assembly::Rows::of(&poses);
        let graph = Arc::clone(&self.graph);
        work::run(py, move || assembly::with_poses(PoseGraph::clone(&graph), &poses))
    }

    /// The graph in which exactly these edges are rejected. The name is that of a new rejection.
    fn with_rejected(&self, rejected: PyReadonlyArray1<'_, bool>, by: &str) -> PyResult<Self> {
        let rejected = rejected.as_array();
        let mut graph = PoseGraph::clone(&self.graph);
        if rejected.len() != graph.edges.len() {
            return Err(Error::new_err(format!(
                "there are {} flags for {}; give one for each edge, in the order of graph.edges",
                rejected.len(),
                posecut_stage::counted(graph.edges.len(), "edge")
            )));
        }
        for (edge, &rejected) in graph.edges.iter_mut().zip(rejected) {
            if rejected {
                edge.reject(by);
            } else {
                edge.readmit();
            }
        }
        Ok(Self::new(graph, None))
    }

    /// The graph without the edges that are rejected.
    fn without_rejected(&self) -> Self {
        let mut graph = PoseGraph::clone(&self.graph);
        graph.edges.retain(Edge::in_use);
        Self::new(graph, None)
    }
}

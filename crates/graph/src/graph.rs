//! A whole pose graph in memory.

use std::io::{BufRead, Write};

use crate::read::read_graph;
use crate::write::write_graph;
use crate::{Edge, EdgeKind, Header, Node, Prior, ReadError, WriteError};

/// A pose graph: header, nodes by id, edges by id, priors by id, and records of unknown kind.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseGraph {
    /// Format, dimension, shared noise models, provenance.
    pub header: Header,
    /// Nodes in ascending order of id.
    pub nodes: Vec<Node>,
    /// Edges in ascending order of id.
    pub edges: Vec<Edge>,
    /// Measurements of single nodes in ascending order of id.
    pub priors: Vec<Prior>,
    /// Records of unknown kind, as read, in their order; they are written at the end.
    pub unknown: Vec<String>,
}

impl PoseGraph {
    /// A graph without nodes.
    pub fn new(header: Header) -> Self {
        Self { header, nodes: Vec::new(), edges: Vec::new(), priors: Vec::new(), unknown: Vec::new() }
    }

    /// Reads and validates a graph; errors call it `source_name`. Nodes, edges and priors may follow the header in any order; they
    /// are sorted by id. O(size).
    pub fn read(source_name: &str, reader: impl BufRead) -> Result<Self, ReadError> {
        read_graph(source_name, reader)
    }

    /// Writes the canonical form: header, nodes by id, edges by id, priors by id, unknown records. Numbers are checked
    /// before the first byte is written.
    pub fn write(&self, writer: impl Write) -> Result<(), WriteError> {
        write_graph(self, writer)
    }

    /// The index of a node in `nodes`. O(1) if ids count from 0, else O(log n).
    pub fn node_index(&self, id: u64) -> Option<usize> {
        let guess = usize::try_from(id).ok()?;
        if self.nodes.get(guess).is_some_and(|node| node.id == id) {
            return Some(guess);
        }
        self.nodes.binary_search_by_key(&id, |node| node.id).ok()
    }

    /// The information matrix of an edge: its own, or that of its noise model.
    pub fn information<'a>(&'a self, edge: &'a Edge) -> Option<&'a [f64]> {
        if let Some(information) = &edge.information {
            return Some(information);
        }
        let name = edge.noise.as_deref()?;
        self.header.noise_model(name).map(|model| model.information.as_slice())
    }

    /// The information matrix of a prior: its own, or that of its noise model.
    pub fn information_of_prior<'a>(&'a self, prior: &'a Prior) -> Option<&'a [f64]> {
        if let Some(information) = &prior.information {
            return Some(information);
        }
        let name = prior.noise.as_deref()?;
        self.header.noise_model(name).map(|model| model.information.as_slice())
    }

    /// Edges of one kind.
    pub fn edges_of(&self, kind: EdgeKind) -> impl Iterator<Item = &Edge> {
        self.edges.iter().filter(move |edge| edge.kind == kind)
    }

    /// The session names in the order of their first node.
    pub fn sessions(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        let mut last = None;
        for node in &self.nodes {
            let name = node.session.as_deref();
            if name == last {
                continue;
            }
            last = name;
            if let Some(name) = name
                && !names.contains(&name)
            {
                names.push(name);
            }
        }
        names
    }

    /// Removes rejected edges and priors from the graph, for tools that do not know the mark `rejected_by`.
    pub fn drop_rejected(&mut self) {
        self.edges.retain(Edge::in_use);
        self.priors.retain(Prior::in_use);
    }

    /// Sorts nodes, edges and priors by id, as in the canonical form.
    pub fn sort(&mut self) {
        self.nodes.sort_by_key(|node| node.id);
        self.edges.sort_by_key(|edge| edge.id);
        self.priors.sort_by_key(|prior| prior.id);
    }
}

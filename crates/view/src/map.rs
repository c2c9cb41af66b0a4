//! A map: poses of all nodes, and what became of all landmark edges.

use posecut_geometry::SE3;
use posecut_graph::{Edge, EdgeKind, PoseGraph};
use serde::Serialize;

use crate::columns::{Column, Witnesses, column, witnesses};
use crate::history::optimised;
use crate::parts::Parts;
use crate::poses::Positions;
use crate::residuals::{Motions, residuals};
use crate::states::States;

/// The landmark edges of the main graph.
pub(crate) struct Edges<'a> {
    pub(crate) all: Vec<&'a Edge>,
    /// Indices of the nodes of each.
    pub(crate) ends: Vec<(usize, usize)>,
}

impl<'a> Edges<'a> {
    pub(crate) fn of(graph: &'a PoseGraph) -> Self {
        let found = graph.edges_of(EdgeKind::Landmark).filter_map(|edge| Some((edge, graph.ends(edge)?)));
        let (all, ends) = found.unzip();
        Self { all, ends }
    }

    /// The same edges in another graph, by id.
    pub(crate) fn in_graph<'b>(&self, other: &'b PoseGraph) -> Vec<Option<&'b Edge>> {
        let found = |edge: &&Edge| {
            let place = other.edges.binary_search_by_key(&edge.id, |edge| edge.id).ok()?;
            Some(&other.edges[place]).filter(|edge| edge.kind == EdgeKind::Landmark)
        };
        self.all.iter().map(found).collect()
    }
}

/// A map as the page stores it.
#[derive(Debug, Serialize)]
pub(crate) struct Map {
    name: String,
    /// Whether an optimiser made its poses.
    optimised: bool,
    /// Absent if no node has a pose.
    positions: Option<Positions>,
    #[serde(flatten)]
    states: States,
    residuals: Option<Motions>,
    columns: Vec<Column>,
    witnesses: Option<Witnesses>,
    pub(crate) parts: Parts,
}

impl Map {
    /// The map of `graph`, with the edges of the main graph `main` and the columns `fields`.
    pub(crate) fn of(
        name: &str,
        main: &PoseGraph,
        edges: &Edges,
        fields: &[String],
        (graph, poses, step): (&PoseGraph, &[Option<SE3>], f64),
    ) -> Self {
        let dimension = main.header.dimension;
        let own = edges.in_graph(graph);
        let positions = Positions::of(poses, dimension, step);
        Self {
            name: name.to_owned(),
            optimised: optimised(&graph.header),
            residuals: positions.is_some().then(|| residuals(dimension, &edges.all, &edges.ends, poses)),
            positions,
            states: States::of(&own),
            columns: fields.iter().filter_map(|field| column(field, &own)).collect(),
            witnesses: witnesses(&own),
            parts: Parts::of(main, graph),
        }
    }
}

//! The signed graph of a pose graph.

use posecut_graph::{EdgeKind, PoseGraph};
use serde::Serialize;

use crate::Graph;
use crate::costs::delta::Delta;
use crate::costs::support::{Support, support};

/// What cutting a landmark edge costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Costs {
    /// +1 with a support edge, -1 without, as in the paper
    Support,
    /// The number of support edges, or -1 if there are none
    Count,
    /// The edge's field "cost" in the file
    Field,
}

/// Which edges the cut graph has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum CutGraph {
    /// Landmark edges only: each component of the result is one landmark
    Landmark,
    /// Landmark and odometry edges: odometry holds each session together
    Full,
}

/// Which signed graph is cut.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct CutOptions {
    /// Count edges at most this far away at both ends as support, frames; `auto` takes the median spacing of each pair of sessions
    #[arg(long, value_name = "FRAMES", default_value_t = Delta::Frames(1))]
    pub delta: Delta,

    /// Choose the cost of cutting a landmark edge
    #[arg(long, value_enum, default_value_t = Costs::Support)]
    pub costs: Costs,

    /// Choose the edges of the signed graph
    #[arg(long, value_enum, default_value_t = CutGraph::Landmark)]
    pub graph: CutGraph,

    /// Set the cost of cutting an odometry edge (`--graph full`)
    #[arg(long, value_name = "COST", default_value_t = 1.0)]
    pub odometry_cost: f64,
}

impl Default for CutOptions {
    /// The options of the paper.
    fn default() -> Self {
        Self { delta: Delta::Frames(1), costs: Costs::Support, graph: CutGraph::Landmark, odometry_cost: 1.0 }
    }
}

/// Indices of edges, each with its cost.
pub(crate) type Priced = Vec<(usize, f64)>;

impl CutOptions {
    /// The index and the cost of each landmark edge in use, with the support that the costs are based on.
    pub(crate) fn costs(&self, graph: &PoseGraph) -> anyhow::Result<(Priced, Option<Support>)> {
        if self.costs == Costs::Field {
            let costs: anyhow::Result<Priced> = graph
                .edges
                .iter()
                .enumerate()
                .filter(|(_, edge)| edge.kind == EdgeKind::Landmark && edge.in_use())
                .map(|(index, edge)| {
                    edge.cost.map(|cost| (index, cost)).ok_or_else(|| {
                        anyhow::anyhow!(
                            "{}: it has no \"cost\"; give every landmark edge one, or use --costs support",
                            edge.name()
                        )
                    })
                })
                .collect();
            return Ok((costs?, None));
        }
        let cost = |count: usize| match (self.costs, count) {
            (_, 0) => -1.0,
            (Costs::Count, count) => count as f64,
            _ => 1.0,
        };
        let support = support(graph, self.delta)?;
        let costs = support.counts.iter().map(|&(index, count)| (index, cost(count))).collect();
        Ok((costs, Some(support)))
    }

    /// The signed graph of a pose graph. Its nodes are the indices of the pose graph's nodes.
    pub fn cut_graph(&self, graph: &PoseGraph) -> anyhow::Result<Graph> {
        self.graph_of(graph, &self.costs(graph)?.0)
    }

    pub(crate) fn graph_of(&self, graph: &PoseGraph, costs: &[(usize, f64)]) -> anyhow::Result<Graph> {
        let mut edges: Vec<_> = costs.iter().map(|&(index, cost)| ends(graph, index, cost)).collect();
        if self.graph == CutGraph::Full {
            anyhow::ensure!(
                self.odometry_cost.is_finite(),
                "--odometry-cost is {}, but must be a finite number",
                self.odometry_cost
            );
            for (index, edge) in graph.edges.iter().enumerate() {
                if edge.kind == EdgeKind::Odometry && edge.in_use() {
                    edges.push(ends(graph, index, self.odometry_cost));
                }
            }
        }
        Ok(Graph::new(graph.nodes.len(), edges)?)
    }
}

fn ends(graph: &PoseGraph, edge: usize, cost: f64) -> (u64, u64, f64) {
    let place = |id| graph.node_index(id).map_or(u64::MAX, |index| index as u64);
    (place(graph.edges[edge].from), place(graph.edges[edge].to), cost)
}

//! The multicut as a stage: marks the landmark edges that an optimal multicut cuts, and labels the landmarks
//! that remain.
//!
//! [`mod@support`] counts the landmark edges between neighbouring frames, within the distance of [`delta`]: the paper's cost of
//! an edge is +1 with such support and -1 without. Depends on [`solve`](crate::solve()) alone; the theory knows no pose graphs.

pub mod delta;
pub(crate) mod landmarks;
pub mod support;

use std::time::Duration;

use posecut_graph::{EdgeKind, PoseGraph};
use posecut_stage::{Context, Doubt, GraphStage, Phase, Place, counted, info};
use serde::Serialize;

use crate::{Graph, Solution, Solver, solve};
use delta::Delta;
use landmarks::{label_landmarks, mark};
use support::{Support, support};

/// What cutting a landmark edge costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Costs {
    /// +1 with a support edge, -1 without: the paper's
    Support,
    /// The number of support edges, -1 without
    Count,
    /// The edge's own "cost" in the file
    Field,
}

/// Which edges the cut graph has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum CutGraph {
    /// Landmark edges alone: a component of the result is one landmark
    Landmark,
    /// Odometry edges too, which tie whole sessions together
    Full,
}

/// The options of the multicut stage.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct StageOptions {
    /// Largest distance of a support edge at each end, frames; `auto` takes the median spacing of each pair of sessions
    #[arg(long, value_name = "FRAMES", default_value_t = Delta::Frames(1))]
    pub delta: Delta,

    /// What cutting a landmark edge costs
    #[arg(long, value_enum, default_value_t = Costs::Support)]
    pub costs: Costs,

    /// Which edges are cut
    #[arg(long, value_enum, default_value_t = CutGraph::Landmark)]
    pub graph: CutGraph,

    /// Cost of cutting an odometry edge, with --graph full
    #[arg(long, value_name = "COST", default_value_t = 1.0)]
    pub odometry_cost: f64,

    /// The algorithm for what reductions leave
    #[arg(long, value_enum, default_value_t = SolverChoice::Exact)]
    pub solver: SolverChoice,

    /// Seconds after which the best solution so far is taken and its gap told
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    pub time_limit: f64,

    /// The same by work, which ends at the same place on every machine
    #[arg(long, value_name = "UNITS")]
    pub work_limit: Option<u64>,
}

/// The algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum SolverChoice {
    /// Bounds and branching until the optimum is proved
    Exact,
    /// Greedy contraction, then Kernighan-Lin with joins
    Klj,
    /// Greedy additive edge contraction
    Gaec,
}

/// Indices of edges, each with its cost.
type Priced = Vec<(usize, f64)>;

impl StageOptions {
    /// How to solve, as the command line says it.
    pub(crate) fn solver_options(&self, certificate: bool) -> anyhow::Result<crate::Options> {
        let time_limit = Duration::try_from_secs_f64(self.time_limit).map_err(|_| {
            anyhow::anyhow!(
                "--time-limit is {}, and must be zero or a positive number of seconds",
                self.time_limit
            )
        })?;
        let solver = match self.solver {
            SolverChoice::Exact => Solver::Exact,
            SolverChoice::Klj => Solver::Klj,
            SolverChoice::Gaec => Solver::Gaec,
        };
        Ok(crate::Options {
            solver,
            time_limit: Some(time_limit),
            work_limit: self.work_limit,
            certificate,
            ..crate::Options::default()
        })
    }

    /// The place of each landmark edge in use and its cost, with the support that costs rest on.
    fn costs(&self, graph: &PoseGraph) -> anyhow::Result<(Priced, Option<Support>)> {
        if self.costs == Costs::Field {
            let costs: anyhow::Result<Priced> = graph
                .edges
                .iter()
                .enumerate()
                .filter(|(_, edge)| edge.kind == EdgeKind::Landmark && edge.in_use())
                .map(|(index, edge)| {
                    edge.cost.map(|cost| (index, cost)).ok_or_else(|| {
                        anyhow::anyhow!(
                            "{}: has no \"cost\"; give every landmark edge one, or take --costs support",
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

    /// The signed graph of a pose graph: its nodes are the places of the pose graph's nodes.
    pub(crate) fn cut_graph(&self, graph: &PoseGraph) -> anyhow::Result<Graph> {
        self.graph_of(graph, &self.costs(graph)?.0)
    }

    fn graph_of(&self, graph: &PoseGraph, costs: &[(usize, f64)]) -> anyhow::Result<Graph> {
        let mut edges: Vec<_> = costs.iter().map(|&(index, cost)| ends(graph, index, cost)).collect();
        if self.graph == CutGraph::Full {
            anyhow::ensure!(
                self.odometry_cost.is_finite(),
                "--odometry-cost is {}, and must be a finite number",
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

    /// Cuts a pose graph: marks the landmark edges cut, labels the landmarks, notes figures.
    pub(crate) fn cut(
        &self,
        graph: &mut PoseGraph,
        certificate: bool,
        context: &mut Context,
    ) -> anyhow::Result<Solution> {
        let (costs, support) = self.costs(graph)?;
        let instance = self.graph_of(graph, &costs)?;
        let options = self.solver_options(certificate)?;
        let solution = solve(&instance, &options);
        let cut_edges = mark(graph, &costs, &solution.labels);
        let landmarks = label_landmarks(graph, &costs, &solution.labels);
        let repulsive = costs.iter().filter(|(_, cost)| *cost < 0.0).count();
        if repulsive == 0 && !costs.is_empty() {
            info!("no landmark edge has a negative cost, so nothing is cut");
        }
        let unsupported_cut = support.as_ref().map(|support| unsupported_and_cut(graph, support));
        let everything = !costs.is_empty() && cut_edges == costs.len();
        let unsupported = match (unsupported_cut, &support) {
            (Some(lone), Some(support)) => self.doubt_missing_support(lone, support, context),
            _ => false,
        };
        match (everything, unsupported) {
            (true, true) => context.also_doubt(Doubt::EverythingCut),
            (true, false) => context.doubt(
                Doubt::EverythingCut,
                format!("all of {} are cut; check their costs", counted(costs.len(), "landmark edge")),
            ),
            _ => {}
        }
        info!("{cut_edges} of {} landmark edges cut, {landmarks} landmarks remain", costs.len());
        let statistics = &mut context.statistics;
        statistics.note("landmark_edges", costs.len());
        statistics.note("unsupported_edges", repulsive);
        if let Some([smallest, largest]) = support.and_then(|support| support.deltas) {
            statistics.note("delta_smallest", smallest);
            statistics.note("delta_largest", largest);
        }
        if let Some(lone) = unsupported_cut {
            statistics.note("cut_without_support", lone);
        }
        note(&solution, options.solver, context);
        let statistics = &mut context.statistics;
        statistics.note("landmarks", landmarks);
        statistics.note("cut_edges", cut_edges);
        Ok(solution)
    }

    /// Doubts a result where most edges are cut for want of a neighbour: that is a matter of their spacing, not of evidence.
    /// Whether it is so.
    fn doubt_missing_support(&self, lone: usize, support: &Support, context: &mut Context) -> bool {
        let all = support.counts.len();
        let Some([smallest, largest]) = support.deltas.filter(|_| 2 * lone > all) else { return false };
        let reach = match (smallest, largest) {
            (1, 1) => "1 frame".to_owned(),
            (one, other) if one == other => format!("{one} frames"),
            (one, other) => format!("{one} to {other} frames"),
        };
        let remedy = match self.delta {
            Delta::Frames(_) => {
                "set --delta to the spacing of the candidates (--delta auto estimates it), or use posecut-verify"
            }
            Delta::Auto => "set a larger --delta, or use posecut-verify",
        };
        context.doubt(
            Doubt::NoSupportWithinDelta,
            format!(
                "{lone} of {} cut only because no other landmark edge is within {reach}, which is no evidence against them; {remedy}",
                if all == 1 { "1 landmark edge is".to_owned() } else { format!("{all} landmark edges are") }
            ),
        );
        true
    }
}

/// Edges that are cut and have no support edge.
fn unsupported_and_cut(graph: &PoseGraph, support: &Support) -> usize {
    support.counts.iter().filter(|&&(index, count)| count == 0 && !graph.edges[index].in_use()).count()
}

/// Notes what is known of a solution, and doubts it if the proof is not complete.
pub(crate) fn note(solution: &Solution, solver: Solver, context: &mut Context) {
    if !solution.optimal {
        let remedy = match solver {
            Solver::Exact => "raise --time-limit or --work-limit",
            _ => "--solver exact searches for a proof",
        };
        context.doubt(
            Doubt::SearchLimit,
            format!(
                "not proved optimal: objective {}, lower bound {}, gap {}; {remedy}",
                solution.objective,
                solution.lower_bound,
                solution.gap()
            ),
        );
    }
    let statistics = &mut context.statistics;
    statistics.note("objective", solution.objective);
    statistics.note("lower_bound", solution.lower_bound);
    statistics.note("gap", solution.gap());
    statistics.note("optimal", solution.optimal);
    statistics.note("kernel_nodes", solution.kernel_nodes);
    statistics.note("kernel_edges", solution.kernel_edges);
    statistics.note("largest_kernel_edges", solution.largest_kernel.1);
    statistics.note("work", solution.work);
}

fn ends(graph: &PoseGraph, edge: usize, cost: f64) -> (u64, u64, f64) {
    let place = |id| graph.node_index(id).map_or(u64::MAX, |index| index as u64);
    (place(graph.edges[edge].from), place(graph.edges[edge].to), cost)
}

impl GraphStage for StageOptions {
    const NAME: &'static str = "multicut";
    const ABOUT: &'static str =
        "Reject the landmark edges that a minimum-cost multicut cuts, and label the landmarks";
    const PLACE: Place = Place(Phase::Judgement, 20);
    const DOUBTS: &'static [Doubt] = &[Doubt::SearchLimit, Doubt::EverythingCut, Doubt::NoSupportWithinDelta];

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        self.cut(graph, false, context).map(drop)
    }
}

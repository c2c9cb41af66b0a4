//! PCM as a stage: marks the landmark edges outside the maximum clique of each group.

use std::time::Instant;

use posecut_geometry::{SE2, SE3};
use posecut_graph::{Dimension, EdgeKind, PoseGraph};
use posecut_stage::{Context, GraphStage, write_atomically};

use crate::calibration::{ScaleEstimate, Scales, estimate_scales};
use crate::candidate::{Group, Grouped, group_with};
use crate::cells::solve_by_cells;
use crate::chain::{Chains, Covariances};
use crate::clique::{BitGraph, Limits, maximum_clique};
use crate::consistency::Pairs;
use crate::dimacs::{NamedGraph, write_dimacs};
use crate::growth::grow;
use crate::readmission::{divide_information, readmit};
use crate::summary::{Summary, note_readmission};
use crate::{Options, PcmError, Scheme, Spatial, Test};

impl GraphStage for Options {
    const NAME: &'static str = "pcm";
    const ABOUT: &'static str =
        "Reject landmark edges outside the largest set that is pairwise consistent with the odometry";

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        self.check()?;
        if let Some(path) = &self.consistency_graph {
            context.check_further_output("--consistency-graph", path)?;
        }
        if self.readmit {
            note_readmission(&readmit(graph, &self.readmission()?)?, context);
            return Ok(());
        }
        let (summary, graphs) = match graph.header.dimension {
            Dimension::Two => reject::<SE2, 3>(self, graph)?,
            Dimension::Three => reject::<SE3, 6>(self, graph)?,
        };
        if let Some(path) = &self.consistency_graph {
            write_atomically(path, |writer| Ok(write_dimacs(writer, &graphs)?))?;
        }
        summary.note(context);
        Ok(())
    }
}

/// Whether a candidate stays, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Clique,
    Grown,
    Outside,
}

impl Role {
    fn name(self) -> &'static str {
        match self {
            Self::Clique => "clique",
            Self::Grown => "grown",
            Self::Outside => "outside",
        }
    }
}

/// What was found out about the candidates of a group.
struct Judged {
    roles: Vec<Role>,
    degrees: Vec<usize>,
    /// The consistency graph with the candidates that its vertices stand for.
    graph: Option<(BitGraph, Vec<usize>)>,
}

impl Judged {
    fn new(
        degrees: Vec<usize>,
        clique: &[usize],
        grown: &[usize],
        graph: Option<(BitGraph, Vec<usize>)>,
    ) -> Self {
        let mut roles = vec![Role::Outside; degrees.len()];
        for &candidate in grown {
            roles[candidate] = Role::Grown;
        }
        for &candidate in clique {
            roles[candidate] = Role::Clique;
        }
        Self { roles, degrees, graph }
    }
}

fn reject<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &mut PoseGraph,
) -> Result<(Summary, Vec<NamedGraph>), PcmError> {
    let (mut chains, mut grouped) = candidates::<G, DOF>(options, graph)?;
    let mut summary = Summary {
        unmeasured: grouped.unmeasured,
        rejected_before: grouped.rejected_before,
        groups: grouped.groups.len(),
        ..Summary::default()
    };
    let limits = options.limits();
    calibrate(options, graph, &mut chains, &mut grouped.groups, &mut summary);
    let mut graphs = Vec::new();
    for group in &grouped.groups {
        let judged = judge(options, &chains, group, limits, &mut summary)?;
        for ((candidate, role), degree) in group.candidates.iter().zip(&judged.roles).zip(&judged.degrees) {
            let edge = &mut graph.edges[candidate.edge];
            edge.extra.insert("pcm_degree".to_owned(), (*degree).into());
            edge.extra.insert("pcm_role".to_owned(), role.name().into());
            if *role == Role::Outside {
                edge.reject(Options::NAME);
            }
        }
        if let Some((consistency, vertices)) = judged.graph {
            let id = |&vertex: &usize| graph.edges[group.candidates[vertex].edge].id;
            graphs.push(NamedGraph { edges: vertices.iter().map(id).collect(), graph: consistency });
        }
    }
    Ok((summary, graphs))
}

/// The chains of a graph and its candidates; without covariances where no test looks at them.
pub(crate) fn candidates<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &PoseGraph,
) -> Result<(Chains<G, DOF>, Grouped<G, DOF>), PcmError> {
    let covariances =
        if options.test == Test::Threshold { Covariances::Ignored } else { Covariances::Needed };
    let chains = Chains::with(graph, covariances)?;
    let grouped = group_with(graph, &chains, covariances)?;
    Ok((chains, grouped))
}

/// Estimates scales where they are asked for, and applies those of the options to chains and candidates.
pub(crate) fn scale<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    chains: &mut Chains<G, DOF>,
    groups: &mut [Group<G, DOF>],
) -> Option<ScaleEstimate> {
    let estimate = if options.wants_estimate() { estimate_scales(chains, groups) } else { None };
    options.scales(estimate).apply(chains, groups);
    estimate
}

/// [`scale`], and with `--calibrate` the same for the informations of the graph.
fn calibrate<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &mut PoseGraph,
    chains: &mut Chains<G, DOF>,
    groups: &mut [Group<G, DOF>],
    summary: &mut Summary,
) {
    let start = Instant::now();
    summary.scale_wanted = options.wants_estimate();
    summary.scale = scale(options, chains, groups);
    if options.calibrate {
        let estimated = summary.scale.map_or(Scales::ONE, |estimate| estimate.scales);
        divide_information(graph, EdgeKind::Odometry, estimated.odometry);
        divide_information(graph, EdgeKind::Landmark, estimated.landmark);
    }
    summary.seconds_scale += start.elapsed().as_secs_f64();
}

fn judge<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    chains: &Chains<G, DOF>,
    group: &Group<G, DOF>,
    limits: Limits,
    summary: &mut Summary,
) -> Result<Judged, PcmError> {
    let count = group.candidates.len();
    let scheme = options.scheme.for_candidates(count);
    if scheme == Scheme::Cells && options.consistency_graph.is_some() {
        return Err(PcmError::GraphNotMade { candidates: count, megabytes: (count * count / 8) >> 20 });
    }
    summary.candidates += count;
    summary.lone_candidates += usize::from(count == 1);
    let pairs = Pairs::new(chains, group).with_odometry_test(!options.no_odometry_test);
    let gate = options.gate(options.probability, count, DOF)?;
    let growth_gate = match options.grow {
        Some(probability) => Some(options.gate(probability, count, DOF)?),
        None => None,
    };
    if scheme == Scheme::Cells {
        let start = Instant::now();
        let solution = solve_by_cells(&pairs, gate, growth_gate.unwrap_or(gate), options.cell_size, limits);
        summary.seconds_clique += start.elapsed().as_secs_f64();
        summary.groups_by_cells += 1;
        summary.cells += solution.cells;
        summary.hypotheses += solution.hypotheses;
        summary.hypotheses_left_out += solution.hypotheses_left_out;
        summary.counts += solution.counts;
        summary.clique_size += solution.members.len();
        // Nothing is proved about candidates that are no hypotheses.
        summary.clique_upper_bound += count;
        summary.grown += solution.grown.len();
        summary.work += solution.clique.work;
        return Ok(Judged::new(solution.degrees, &solution.members, &solution.grown, None));
    }
    let start = Instant::now();
    let (tested, graph, counts) = pairs.tested_graph(gate);
    summary.against_odometry += count - tested.len();
    summary.seconds_pairs += start.elapsed().as_secs_f64();
    summary.counts += counts;
    let start = Instant::now();
    let clique = maximum_clique(&graph, limits);
    summary.seconds_clique += start.elapsed().as_secs_f64();
    summary.clique_size += clique.vertices.len();
    summary.clique_upper_bound += clique.upper_bound;
    summary.work += clique.work;
    let members: Vec<usize> = clique.vertices.iter().map(|&vertex| tested[vertex]).collect();
    let start = Instant::now();
    let grown = match growth_gate {
        Some(gate) => {
            let (grown, counts) = grow(&pairs, &members, gate);
            summary.counts += counts;
            grown
        }
        None => Vec::new(),
    };
    summary.seconds_growth += start.elapsed().as_secs_f64();
    summary.grown += grown.len();
    let mut degrees = vec![0; count];
    for (vertex, &candidate) in tested.iter().enumerate() {
        degrees[candidate] = graph.degree(vertex);
    }
    let graph = options.consistency_graph.is_some().then_some((graph, tested));
    Ok(Judged::new(degrees, &members, &grown, graph))
}

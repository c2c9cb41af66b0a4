//! PCM on a pose graph: judges every group of candidates by the options, with one budget of work for all.

use std::time::Instant;

use posecut_graph::{EdgeKind, PoseGraph, for_dimension};

use crate::budget::Budget;
use crate::calibration::{NoScales, ScaleEstimate, Scales, divide_information};
use crate::chance::Pool;
use crate::clique::dimacs::NamedGraph;
use crate::judgement::figures::Figures;
use crate::judgement::judge;
use crate::odometry::chain::Chains;
use crate::pairs::candidate::Group;
use crate::preparation::{candidates, scale};
use crate::{Options, PcmError, Spatial};

/// The result of PCM on a graph.
#[derive(Clone, Debug)]
pub struct Rejection {
    /// Pairs of chains that have candidates.
    pub groups: usize,
    /// Landmark edges without a measurement: neither tested nor rejected.
    pub unmeasured: usize,
    /// Landmark edges that an earlier stage has rejected.
    pub rejected_before: usize,
    /// Figures over all groups.
    pub judged: Figures,
    /// The result of calibration.
    pub calibration: Calibration,
    /// The consistency graphs, if they are kept.
    pub graphs: Vec<NamedGraph>,
    /// A warning, if there is one: [`Chains::warning`].
    pub warning: Option<String>,
}

/// The result of calibration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Calibration {
    /// The estimate, if it was requested.
    pub scale: Option<Result<ScaleEstimate, NoScales>>,
    /// Its time in seconds.
    pub seconds: f64,
}

/// The progress of a run, in pairs of candidates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pairs of the groups judged so far.
    pub done: u64,
    /// Pairs of all groups.
    pub all: u64,
}

/// Rejects the landmark edges of a graph that are outside the maximum clique of their group, and writes the evidence to all
/// of them. `keep_graphs` keeps the consistency graphs, all in memory at the same time. `progress` is called before the
/// first group and after each.
pub fn reject(
    options: &Options,
    graph: &mut PoseGraph,
    keep_graphs: bool,
    progress: impl FnMut(Progress),
) -> Result<Rejection, PcmError> {
    options.check()?;
    for_dimension!(graph.header.dimension, |G, DOF| reject_in::<G, DOF>(
        options,
        graph,
        keep_graphs,
        progress
    ))
}

fn reject_in<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &mut PoseGraph,
    keep_graphs: bool,
    mut progress: impl FnMut(Progress),
) -> Result<Rejection, PcmError> {
    let (mut chains, mut grouped) = candidates::<G, DOF>(options, graph)?;
    let deadline = options.deadline();
    let calibration = calibrate(options, graph, &mut chains, &mut grouped.groups);
    let mut rejection = Rejection {
        unmeasured: grouped.unmeasured,
        rejected_before: grouped.rejected_before,
        groups: grouped.groups.len(),
        judged: Figures::default(),
        calibration,
        graphs: Vec::new(),
        warning: chains.warning(),
    };
    // Without --chance every group is judged by itself, as PCM is defined.
    let pool = options.chance.map(|_| Pool::of(&chains, &grouped.groups));
    let candidates = || grouped.groups.iter().map(|group| group.candidates.len());
    let mut budget = Budget::of(candidates());
    // The time of a group grows with the pairs of its candidates.
    let mut reached = Progress { done: 0, all: candidates().map(pairs).sum() };
    progress(reached);
    for group in &grouped.groups {
        let count = group.candidates.len();
        let alone = options.limits(count, deadline);
        let judged = judge(options, &chains, group, pool, budget.next(count, alone), keep_graphs)?;
        budget.spend(count, alone, judged.figures.work);
        reached.done += pairs(count);
        progress(reached);
        judged.mark(graph, group);
        if let Some((consistency, vertices)) = judged.graph {
            let id = |&vertex: &usize| graph.edges[group.candidates[vertex].edge].id;
            rejection
                .graphs
                .push(NamedGraph { edges: vertices.iter().map(id).collect(), graph: consistency });
        }
        rejection.judged += judged.figures;
    }
    Ok(rejection)
}

/// The number of pairs among this many candidates, plus one for the group.
fn pairs(candidates: usize) -> u64 {
    let count = candidates as u64;
    count * count.saturating_sub(1) / 2 + 1
}

/// Calls [`scale`]; with `--calibrate`, also rescales the information matrices of the graph.
fn calibrate<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &mut PoseGraph,
    chains: &mut Chains<G, DOF>,
    groups: &mut [Group<G, DOF>],
) -> Calibration {
    let start = Instant::now();
    let scale = scale(options, chains, groups);
    if options.calibrate {
        let estimated = scale.and_then(Result::ok).map_or(Scales::ONE, |estimate| estimate.scales);
        divide_information(graph, EdgeKind::Odometry, estimated.odometry);
        divide_information(graph, EdgeKind::Landmark, estimated.landmark);
    }
    Calibration { scale, seconds: start.elapsed().as_secs_f64() }
}

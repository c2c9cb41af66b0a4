//! From one connected component to its minimum: a start, and a descent from it.

use std::cmp::Ordering;
use std::collections::VecDeque;

use super::continuation::{Found, continued};
use super::solution::{ComponentReport, Start};
use crate::descent::phases::{Phases, timed};
use crate::descent::workspace::Workspace;
use crate::initialisation::tree::spanning_tree_from;
use crate::model::cost::{cost, exceeds};
use crate::model::magnitude::Magnitude;
use crate::model::problem::Problem;
use crate::normal_equations::{Pattern, System};
use crate::options::{Initialisation, Options};
use crate::pose_group::{PoseGroup, Relaxation};
use posecut_cholesky::Memory;

/// A descent from the relaxation that takes more steps than this has probably begun in the wrong basin.
const HARD: usize = 20;
/// Factorisations after which the descents after it may count as slow.
const RESUMED: usize = 5;

/// Whether SE-Sync's cost stands for the cost of the graph: without kernels and priors, and with at most one held node.
fn may_be_lifted<G: PoseGroup<DOF>, const DOF: usize>(part: &Problem<G, DOF>, held: usize) -> bool {
    held <= 1 && part.priors().is_empty() && part.edges().iter().all(|edge| edge.kernel.is_none())
}

/// Start, result, report and system of a component.
pub(super) type Solved<G, const DOF: usize> = (Vec<G>, Vec<G>, ComponentReport, Option<System<DOF>>);

/// Chooses a start of a connected graph whose first `held` nodes keep their poses, and solves from it.
///
/// Without kernels the relaxation is tried first: the cost of a start says little about its basin if a few stiff edges
/// dominate. If the descent from it is hard, it halts, and the start of [`continuation`](super::continuation) is tried; it goes on if it is
/// still the lower one then, or if that start comes from a race. If the result costs more than another *start*, that start is tried too,
/// and the lowest result is kept. With kernels, the cheapest start is tried first, since the relaxation ignores outliers.
pub(super) fn solve_component<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    held: usize,
    options: &Options,
    memory: Memory,
) -> Solved<G, DOF> {
    let edges = part.edges();
    let given = part.poses();
    let settled = is_settled(part, held);
    // From the given poses, the descent computes their cost anyway.
    let known = settled || options.initialisation != Initialisation::Given;
    let cost_given = if known { cost(part, given) } else { f64::NAN };
    let mut report = ComponentReport::untouched(given.len(), edges.len(), cost_given);
    if settled {
        return (given.to_vec(), given.to_vec(), report, None);
    }
    let mut phases = Phases::default();
    let pattern = timed(&mut phases.analysis, || Pattern::of(given.len(), held, edges));
    report.factor_blocks = pattern.symbolic.factor_blocks();
    report.flops = pattern.symbolic.flops();
    let mut workspace =
        Workspace::new(&pattern, Magnitude::of(edges.iter()), memory).with_priors(part.priors());
    let mut best: Option<(Vec<G>, Vec<G>)> = None;
    let starts = timed(&mut phases.start, || {
        candidates(part, &mut workspace, options.initialisation, report.cost_given)
    });
    let mut starts = VecDeque::from(starts);
    let mut others_known = options.initialisation != Initialisation::Best || starts.len() > 1;
    // Who allows no more steps than that does not pay for a detour.
    let detour = options.initialisation == Initialisation::Best
        && options.graduated.is_none()
        && options.max_iterations > HARD
        && may_be_lifted(part, held);
    loop {
        if starts.is_empty() && !others_known {
            others_known = true;
            starts.extend(timed(&mut phases.start, || others(part, held, &report)));
        }
        let Some(mut candidate) = starts.pop_front() else { break };
        if best.is_some()
            && candidate.start != Start::Lifted
            && candidate.reached().partial_cmp(&report.cost) != Some(Ordering::Less)
        {
            continue;
        }
        let may_halt = detour && candidate.start == Start::Chordal && candidate.halted.is_none();
        let steps = if may_halt { HARD } else { options.max_iterations };
        let mut result = candidate.halted.take().map_or_else(|| candidate.poses.clone(), |(poses, _)| poses);
        let limited = Options { max_iterations: steps, ..*options };
        let outcome = workspace.minimise(edges, &mut result, &limited);
        report.count(&outcome);
        if !known {
            candidate.cost = outcome.initial;
            report.cost_given = outcome.initial;
        }
        if may_halt && !outcome.termination.converged() {
            // What ends a hard descent sooner from here on must not end it before it counts as one.
            workspace.patience = RESUMED;
            let lifted = continued(&mut workspace, edges, &candidate.poses, options, &mut report);
            // Of a race, the winner need not be lower than what the descent from the relaxation comes to.
            let tight = lifted.as_ref().is_some_and(|found| found.is_tight);
            let reached = if tight { outcome.cost } else { f64::NEG_INFINITY };
            starts.push_front(Candidate { halted: Some((result, reached)), ..candidate });
            if let Some(Found { poses, .. }) = lifted {
                starts.push_front(Candidate::new(Start::Lifted, cost(part, &poses), poses));
            }
            continue;
        }
        if best.is_none() || outcome.cost < report.cost {
            report.adopt(candidate.start, candidate.cost, &outcome);
            best = Some((candidate.poses, result));
        }
    }
    let (start, result) = best.unwrap_or_else(|| (given.to_vec(), given.to_vec()));
    report.phases += phases;
    report.phases += workspace.phases;
    let Workspace { equations, factor, .. } = workspace;
    (start, result, report, Some(System { pattern, equations, memory: factor.into_memory() }))
}

/// Whether a component has nothing to optimise.
pub(super) fn is_settled<G: PoseGroup<DOF>, const DOF: usize>(part: &Problem<G, DOF>, held: usize) -> bool {
    (part.edges().is_empty() && part.priors().is_empty()) || held == part.poses().len()
}

/// A start that edges alone gave, moved to the priors if no node is held.
pub(super) fn aligned<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    held: usize,
    mut poses: Vec<G>,
) -> Vec<G> {
    if held == 0 {
        let motion = G::aligning(part.priors(), &poses);
        for pose in &mut poses {
            *pose = motion.compose(pose);
        }
    }
    poses
}

/// A proposed start.
struct Candidate<G> {
    start: Start,
    poses: Vec<G>,
    cost: f64,
    /// The poses that a descent had reached when it halted, and the cost by which it is compared.
    halted: Option<(Vec<G>, f64)>,
}

impl<G> Candidate<G> {
    fn new(start: Start, cost: f64, poses: Vec<G>) -> Self {
        Self { start, poses, cost, halted: None }
    }

    /// The lowest cost known from here.
    fn reached(&self) -> f64 {
        self.halted.as_ref().map_or(self.cost, |(_, cost)| *cost)
    }
}

/// The starts asked for, in the order in which they should be tried; at least one.
fn candidates<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    workspace: &mut Workspace<'_, G, DOF>,
    initialisation: Initialisation,
    cost_given: f64,
) -> Vec<Candidate<G>> {
    let edges = part.edges();
    let propose = |start: Start, poses: Vec<G>| Candidate::new(start, cost(part, &poses), poses);
    let given = || Candidate::new(Start::Given, cost_given, part.poses().to_vec());
    let first = workspace.pattern.held;
    let tree = || {
        let poses = spanning_tree_from(first, part.poses(), edges);
        propose(Start::SpanningTree, aligned(part, first, poses))
    };
    let mut relaxed = || {
        let mut memory = Relaxation { pattern: workspace.pattern, factor: &mut workspace.factor };
        let held = &part.poses()[..memory.pattern.held];
        G::chordal_poses(&mut memory, edges, held, &part.poses()[0])
            .map(|poses| propose(Start::Chordal, aligned(part, first, poses)))
            .filter(|candidate| candidate.cost.is_finite())
    };
    match initialisation {
        Initialisation::Given => vec![given()],
        Initialisation::SpanningTree => vec![tree()],
        // If the relaxation is singular, the tree replaces it.
        Initialisation::Chordal => vec![relaxed().unwrap_or_else(tree)],
        Initialisation::Best => {
            let robust = edges.iter().any(|edge| edge.kernel.is_some())
                || part.priors().iter().any(|prior| prior.kernel.is_some());
            let mut relaxed = relaxed();
            // The other starts come after the descent from the relaxation: its cost mostly excludes them early.
            if let Some(relaxed) = relaxed.take_if(|_| !robust) {
                return vec![relaxed];
            }
            let mut others = vec![given(), tree()];
            others.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            let mut all: Vec<_> = relaxed.into_iter().chain(others).collect();
            if robust {
                all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            }
            // NaN is not comparable: with it, the other starts would not be tried.
            if all.iter().any(|candidate| candidate.cost.is_finite()) {
                all.retain(|candidate| candidate.cost.is_finite());
            }
            all
        }
    }
}

/// The given poses and the spanning tree, if they cost less than the result so far; the cheaper one first.
fn others<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    held: usize,
    report: &ComponentReport,
) -> Vec<Candidate<G>> {
    let mut all = Vec::new();
    if report.cost_given < report.cost {
        all.push(Candidate::new(Start::Given, report.cost_given, part.poses().to_vec()));
    }
    let tree = aligned(part, held, spanning_tree_from(held, part.poses(), part.edges()));
    if !exceeds(part.edges(), &tree, report.cost) {
        all.push(Candidate::new(Start::SpanningTree, cost(part, &tree), tree));
    }
    all.retain(|candidate| candidate.cost < report.cost);
    all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    all
}

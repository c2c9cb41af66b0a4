//! From one connected component to its minimum: a start, and a descent from it.

use std::cmp::Ordering;

use super::continuation::{Found, continued};
use super::solution::{ComponentReport, Start};
use super::starts::{Candidate, candidates, first_candidates, may_be_lifted, others};
use crate::descent::phases::{Phases, timed};
use crate::descent::workspace::Workspace;
use crate::model::cost::cost;
use crate::model::magnitude::Magnitude;
use crate::model::problem::Problem;
use crate::normal_equations::{Pattern, System};
use crate::options::{Initialisation, Options};
use crate::pose_group::PoseGroup;
use posecut_cholesky::Memory;

/// A descent from the relaxation that takes more steps than this has probably begun in the wrong basin.
const HARD: usize = 20;
/// Factorisations after which the descents after it may count as slow.
const RESUMED: usize = 5;

/// Start, result, report and system of a component.
pub(super) type Solved<G, const DOF: usize> = (Vec<G>, Vec<G>, ComponentReport, Option<System<DOF>>);

/// Whether a hard descent from the relaxation may halt for another start. Who allows no more steps than [`HARD`] does not pay for that.
fn allows_detour<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    held: usize,
    options: &Options,
) -> bool {
    options.initialisation == Initialisation::Best
        && options.graduated.is_none()
        && options.max_iterations > HARD
        && may_be_lifted(part, held)
}

/// Chooses a start of a connected graph whose first `held` nodes keep their poses, and solves from it.
///
/// If the given poses are [near](super::starts::is_near), they are the start; if the descent from there is hard, the others are tried as if
/// they were not.
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
    let (mut starts, mut near) = timed(&mut phases.start, || {
        first_candidates(part, &mut workspace, options.initialisation, report.cost_given)
    });
    let mut others_known = options.initialisation != Initialisation::Best || starts.len() > 1;
    let detour = allows_detour(part, held, options);
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
        let steps = if may_halt || near { HARD.min(options.max_iterations) } else { options.max_iterations };
        let mut result = candidate.halted.take().map_or_else(|| candidate.poses.clone(), |(poses, _)| poses);
        let limited = Options { max_iterations: steps, ..*options };
        let outcome = workspace.minimise(edges, &mut result, &limited);
        report.count(&outcome);
        if std::mem::take(&mut near) && !outcome.termination.converged() {
            starts.extend(timed(&mut phases.start, || {
                candidates(part, &mut workspace, options.initialisation, report.cost_given)
            }));
            continue;
        }
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

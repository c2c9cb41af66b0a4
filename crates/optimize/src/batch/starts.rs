//! The starts of a connected component, and when each is tried.

use std::collections::VecDeque;

use super::solution::{ComponentReport, Start};
use crate::descent::workspace::Workspace;
use crate::initialisation::tree::spanning_tree_from;
use crate::model::cost::{cost, exceeds};
use crate::model::problem::Problem;
use crate::options::Initialisation;
use crate::pose_group::{PoseGroup, Relaxation};

/// Given poses that cost more than so many times what noise leaves are too far from the minimum to be quicker than the relaxation.
const NEAR: f64 = 2.0;

/// A proposed start.
pub(super) struct Candidate<G> {
    pub(super) start: Start,
    pub(super) poses: Vec<G>,
    pub(super) cost: f64,
    /// The poses that a descent had reached when it halted, and the cost by which it is compared.
    pub(super) halted: Option<(Vec<G>, f64)>,
}

impl<G> Candidate<G> {
    pub(super) fn new(start: Start, cost: f64, poses: Vec<G>) -> Self {
        Self { start, poses, cost, halted: None }
    }

    /// The lowest cost known from here.
    pub(super) fn reached(&self) -> f64 {
        self.halted.as_ref().map_or(self.cost, |(_, cost)| *cost)
    }
}

/// Whether SE-Sync's cost stands for the cost of the graph: without kernels and priors, and with at most one held node.
pub(super) fn may_be_lifted<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    held: usize,
) -> bool {
    held <= 1 && part.priors().is_empty() && part.edges().iter().all(|edge| edge.kernel.is_none())
}

/// Whether the given poses miss their edges by little more than the noise that the information states, and surely lie in the right basin of
/// rotations. Then no relaxation is needed.
fn is_near<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    held: usize,
    cost_given: f64,
) -> bool {
    let edges = part.edges();
    // With one node held, what noise leaves of the cost at the minimum on average.
    let expected = (edges.len() * DOF).saturating_sub((part.poses().len() - 1) * DOF) as f64;
    // The cheapest condition first: most graphs fail it.
    cost_given <= NEAR * expected && may_be_lifted(part, held) && G::is_unwound(edges, part.poses())
}

/// The starts to try first, and whether they are the given poses since those are near.
pub(super) fn first_candidates<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    workspace: &mut Workspace<'_, G, DOF>,
    initialisation: Initialisation,
    cost_given: f64,
) -> (VecDeque<Candidate<G>>, bool) {
    let near = initialisation == Initialisation::Best && is_near(part, workspace.pattern.held, cost_given);
    let wanted = if near { Initialisation::Given } else { initialisation };
    (candidates(part, workspace, wanted, cost_given).into(), near)
}

/// The starts asked for, in the order in which they should be tried; at least one.
pub(super) fn candidates<G: PoseGroup<DOF>, const DOF: usize>(
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
pub(super) fn others<G: PoseGroup<DOF>, const DOF: usize>(
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

//! Graduation of one connected component, from several starts.

use super::component::{Solved, is_settled, solve_component};
use super::graduated::{set_landmark_kernels, set_prior_kernels, with_kernels};
use super::solution::Start;
use super::starts::aligned;
use crate::descent::outcome::Outcome;
use crate::descent::phases::timed;
use crate::descent::workspace::Workspace;
use crate::initialisation::tree::spanning_tree_from;
use crate::model::cost::cost;
use crate::model::lanes::LaneGroup;
use crate::model::magnitude::Magnitude;
use crate::model::problem::{Edge, Problem};
use crate::normal_equations::{Pattern, System};
use crate::options::{Graduated, Initialisation, Options};
use crate::pose_group::PoseGroup;
use posecut_cholesky::Memory;

/// A way from a start to a minimum of the robust cost.
#[derive(Clone, Copy)]
enum Way {
    /// Through the surrogates of this graduation.
    Graduated(Graduated),
    /// Through the minimum of Geman-McClure's cost of this width. Where odometry is good, correct landmark edges nearly agree with the
    /// spanning tree, and false ones have no weight from the start: where nine in ten are false, this ends lowest.
    Smooth(f64),
    /// Down the robust cost itself.
    Direct,
}

/// Graduation from the result of [`solve_component`] without kernels on the landmark edges. That start needs no detour: the lowest
/// minimum of all edges is the one that obeys false edges most. If the best start is asked for, further ways follow, and the result of
/// lowest cost is kept:
///
/// - from the spanning tree, since false edges may fold the former result so that no surrogate unfolds it, while odometry drifts but never
///   folds: by truncated least squares, and smoothly;
/// - from the given poses, where they cost less than all results: none costs more than the poses of the input.
pub(super) fn graduated_component<G: PoseGroup<DOF>, const DOF: usize>(
    part: &Problem<G, DOF>,
    held: usize,
    graduation: Graduated,
    options: &Options,
    memory: Memory,
) -> Solved<G, DOF> {
    let edges = part.edges();
    if is_settled(part, held) {
        return solve_component(part, held, options, memory);
    }
    let (start, solved, mut report, system) =
        solve_component(&with_kernels(part, None), held, options, memory);
    let memory = system.map(|system| system.memory).unwrap_or_default();
    let pattern = timed(&mut report.phases.analysis, || Pattern::of(part.poses().len(), held, edges));
    let magnitude = Magnitude::of(edges.iter());
    let mut workspace = Workspace::new(&pattern, magnitude, memory).with_priors(part.priors());
    report.cost_given = cost(part, part.poses());
    report.cost = f64::INFINITY;
    let (plain, cost_given) = (report.start, report.cost_given);
    let mut best = None;
    let mut go = |name: Start, start: &[G], from: &[G], way: Way| {
        let mut poses = from.to_vec();
        let outcome = way.minimise(graduation, &mut workspace, edges, &mut poses, options);
        report.count(&outcome);
        if best.is_none() || outcome.cost < report.cost {
            report.adopt(name, cost(part, start), &outcome);
            best = Some((start.to_vec(), poses));
        }
        report.cost
    };
    if options.initialisation == Initialisation::Best {
        let tree = aligned(part, held, spanning_tree_from(held, part.poses(), edges));
        go(plain, &start, &solved, Way::Graduated(graduation));
        // Geman-McClure's surrogates feel every false edge a little, and where half of the edges are false they mostly settle beside the
        // correct ones; truncated surrogates let false edges go.
        let truncated = Graduated::TruncatedLeastSquares(graduation.width());
        go(Start::SpanningTree, &tree, &tree, Way::Graduated(truncated));
        let smooth = Way::Smooth(graduation.width());
        let mut lowest = go(Start::SpanningTree, &tree, &tree, smooth);
        for way in [smooth, Way::Direct] {
            if cost_given < lowest {
                lowest = go(Start::Given, part.poses(), part.poses(), way);
            }
        }
    } else {
        go(plain, &start, &solved, Way::Graduated(graduation));
    }
    let (start, result) = best.unwrap_or_else(|| (part.poses().to_vec(), part.poses().to_vec()));
    report.phases += workspace.phases;
    let Workspace { equations, factor, .. } = workspace;
    (start, result, report, Some(System { pattern, equations, memory: factor.into_memory() }))
}

impl Way {
    /// Minimises the cost that `graduation` ends with, whose kernels `edges` have. The outcome counts all steps.
    fn minimise<G: LaneGroup<DOF>, const DOF: usize>(
        self,
        graduation: Graduated,
        workspace: &mut Workspace<'_, G, DOF>,
        edges: &[Edge<G, DOF>],
        poses: &mut [G],
        options: &Options,
    ) -> Outcome {
        let before = match self {
            Self::Graduated(own) if own == graduation => {
                return own.minimise(workspace, edges, poses, options);
            }
            Self::Graduated(other) => other.minimise(workspace, edges, poses, options),
            Self::Smooth(width) => {
                let kernel = Some(Graduated::GemanMcClure(width).kernel());
                let mut smooth = edges.to_vec();
                set_landmark_kernels(&mut smooth, kernel);
                set_prior_kernels(&mut workspace.priors, kernel);
                workspace.minimise(&smooth, poses, options)
            }
            Self::Direct => Outcome::new(f64::NAN),
        };
        set_prior_kernels(&mut workspace.priors, Some(graduation.kernel()));
        let outcome = workspace.minimise(edges, poses, options);
        outcome.after(&before)
    }
}

//! A start for noisy rotations: follows the minimum from weak translations to the graph's own.
//!
//! The chordal relaxation finds rotations without the translations, the limit of translations without weight. Where rotations are noisy
//! and translations are stiff, that is far from the minimum, in a cost full of ravines. So the information of all translations is first
//! scaled down until the median measured translation says as much about rotations as the median measured rotation does. The minimum there
//! is found in more dimensions ([`lifted`](crate::lifted)). Then the scale rises, and each descent starts at the minimum before it
//! (a homotopy: E. L. Allgower, K. Georg, "Numerical Continuation Methods", 1990). Depends on `descent`, `lifted` and `pose_group`.

use posecut_geometry::{LieGroup, translations};

use super::solution::ComponentReport;
use crate::descent::phases::timed;
use crate::descent::workspace::Workspace;
use crate::effort::Effort;
use crate::model::magnitude::median_of_positive;
use crate::model::problem::Edge;
use crate::options::Options;
use crate::pose_group::PoseGroup;

/// The scale rises by this factor.
const RISE: f64 = 4.0;

/// Shares of the first scale at which the minimum in more dimensions is found. The weaker the translations, the fewer minima, and the further
/// away: of 65 graphs with false edges or noise, a lower minimum than that found was known on 15 with either share alone, on 11 with both.
const SHARES: [f64; 2] = [1.0, 0.1];

/// The search ends after this many operations, some twenty seconds on one core, and is left out where they do not suffice for the steps at one
/// scale. With half as many, M3500 with 50 % of false edges ends 1 % higher, and torus3D with 10 % ends 41 % higher. Without a limit, five sessions of
/// 12,600 poses in all with 30 % of false edges took two minutes.
const SEARCH: f64 = 4e11;

/// Steps tried at a scale. The next scale needs no exact minimum.
const STEPS: usize = 20;

/// The share by which a step must lower the cost for the descent to go on.
const ROUGH: f64 = 1e-4;

/// The scale at which the median edge's translation says as much about a rotation as its rotation: `tr(I_rr) / (tr(I_tt) |z|^2)`, both
/// traces divided by their size; at most 1.
fn first_scale<G: LieGroup<DOF>, const DOF: usize>(edges: &[Edge<G, DOF>]) -> f64 {
    let split = translations(DOF);
    let mean = |edge: &Edge<G, DOF>, axes: std::ops::Range<usize>| {
        let size = axes.len() as f64;
        axes.map(|axis| edge.information[(axis, axis)]).sum::<f64>() / size
    };
    let ratio = |edge: &Edge<G, DOF>| {
        let distance = edge.measurement.log().rows(0, split).norm_squared();
        mean(edge, split..DOF) / (mean(edge, 0..split) * distance)
    };
    median_of_positive(edges.iter().map(ratio)).unwrap_or(1.0).min(1.0)
}

/// The edges with the information of their translations scaled; `S I S` with `S = diag(sqrt(scale), 1)` remains positive definite.
fn scaled<G: LieGroup<DOF>, const DOF: usize>(edges: &[Edge<G, DOF>], scale: f64) -> Vec<Edge<G, DOF>> {
    let split = translations(DOF);
    let root = scale.sqrt();
    let mut all = edges.to_vec();
    for edge in &mut all {
        for axis in 0..split {
            edge.information.row_mut(axis).scale_mut(root);
            edge.information.column_mut(axis).scale_mut(root);
        }
    }
    all
}

/// A start, and whether it comes from a tight relaxation, and not from a race or a search that its limit ended.
pub(super) struct Found<G> {
    pub(super) poses: Vec<G>,
    pub(super) is_tight: bool,
}

/// Poses near the minimum of a graph, found from those of the relaxation: the minimum of SE-Sync's cost in more dimensions where
/// translations are weak ([`lifted`](crate::lifted)), followed to the graph's own information. If the relaxation is not tight, projections at
/// two scales run a race, as many of them as the effort affords. `None` if SE-Sync's cost does not exist, or a descent takes too many
/// operations. The descents are counted in the report.
pub(super) fn continued<G: PoseGroup<DOF>, const DOF: usize>(
    workspace: &mut Workspace<'_, G, DOF>,
    edges: &[Edge<G, DOF>],
    relaxed: &[G],
    options: &Options,
    report: &mut ComponentReport,
) -> Option<Found<G>> {
    let rough = Options { max_iterations: STEPS, cost_tolerance: ROUGH, ..*options };
    let first = first_scale(edges);
    let mut race = Race { workspace, edges, rough, report, effort: Effort::of(SEARCH) };
    if race.effort.affords(race.flops(), STEPS) < STEPS {
        return None;
    }
    let mut runners = Vec::new();
    for share in SHARES {
        if race.effort.is_spent() {
            break;
        }
        let Some(mut starts) = race.starts(share * first, relaxed) else { break };
        if let ([only], true) = (&mut starts[..], runners.is_empty()) {
            race.follow(share * first, only);
            let is_tight = !race.effort.is_spent();
            return starts.pop().map(|poses| Found { poses, is_tight });
        }
        for mut poses in starts {
            race.follow(share * first, &mut poses);
            if race.effort.is_spent() {
                break;
            }
            let cost = race.descend(1.0, &mut poses);
            runners.push((cost, poses));
        }
    }
    race.winner(runners).map(|poses| Found { poses, is_tight: false })
}

/// Descents from several starts.
struct Race<'a, 'b, G, const DOF: usize> {
    workspace: &'a mut Workspace<'b, G, DOF>,
    edges: &'a [Edge<G, DOF>],
    rough: Options,
    report: &'a mut ComponentReport,
    effort: Effort,
}

impl<G: PoseGroup<DOF>, const DOF: usize> Race<'_, '_, G, DOF> {
    /// Operations of a factorisation.
    fn flops(&self) -> f64 {
        self.workspace.pattern.symbolic.flops()
    }

    /// Projections from more dimensions where the information of translations has this scale.
    fn starts(&mut self, scale: f64, relaxed: &[G]) -> Option<Vec<Vec<G>>> {
        let scaled = scaled(self.edges, scale);
        timed(&mut self.workspace.phases.start, || G::lifted_poses(&scaled, relaxed, &mut self.effort))
    }

    /// Follows the minimum from this scale to the last one below 1.
    fn follow(&mut self, mut scale: f64, poses: &mut [G]) {
        while scale < 1.0 && !self.effort.is_spent() {
            self.descend(scale, poses);
            scale *= RISE;
        }
    }

    /// Descends at a scale; returns the cost.
    fn descend(&mut self, scale: f64, poses: &mut [G]) -> f64 {
        let scaled = (scale < 1.0).then(|| scaled(self.edges, scale));
        let edges = scaled.as_deref().unwrap_or(self.edges);
        let outcome = self.workspace.minimise(edges, poses, &self.rough);
        self.effort.compute(outcome.factorizations as f64 * self.flops());
        self.report.count(&outcome);
        outcome.cost
    }

    /// Halves the runners by their cost, and lets the rest descend further, until two are left or the effort is spent; of these the lowest.
    /// `None` of none.
    fn winner(&mut self, mut runners: Vec<(f64, Vec<G>)>) -> Option<Vec<G>> {
        loop {
            runners.sort_by(|a, b| a.0.total_cmp(&b.0));
            if runners.len() <= 2 || self.effort.is_spent() {
                return runners.into_iter().next().map(|(_, poses)| poses);
            }
            runners.truncate(runners.len() / 2);
            for (cost, poses) in &mut runners {
                *cost = self.descend(1.0, poses);
            }
        }
    }
}

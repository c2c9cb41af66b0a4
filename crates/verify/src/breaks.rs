//! Where the odometry of a chain is broken.
//!
//! Wheels slip and robots are turned by hand: a step or two are wrong far beyond their covariances, and correct edges behind
//! them contradict the map. Groups of false edges contradict it, too. The motion over the broken steps distinguishes the two:
//! with correct edges the robot moves as usual or slower, with false edges it jumps anywhere.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::covariance::{inverse, to_body};
use posecut_graph::{Edge, EdgeKind, PoseGraph};
use posecut_pcm::chain::Chain;

use crate::cut::COST;
use crate::evidence::compare;
use crate::islands::Hypothesis;
use crate::model::Motion;
use crate::rounds::Rounds;
use crate::slips::slips;
use crate::usual::{stretches, usual_motion};

/// Members of a group that are examined next to a break.
const WITNESSES: usize = 9;
/// Most steps of a break. Over more steps, chance is as close as the usual motion.
const LONGEST: usize = 10;

/// Indices, among the graph's edges, of broken odometry: steps that no accepted loop spans ([`slips`]), or else the steps
/// before and after groups that the map does not support. Such a group lies on a stretch of a chain without accepted closures,
/// and the robot reaches it by a motion that chance does not explain. If this holds on one side only, the other side may be
/// part of the same error.
pub(crate) fn breaks<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    rounds: &Rounds<'_, G, DOF>,
) -> Vec<usize> {
    let Some(poses) = &rounds.poses else { return Vec::new() };
    let mut steps = slips(rounds, poses);
    if steps.is_empty() {
        // Each group is examined from both sides.
        let strong = || rounds.hypotheses.iter().filter(|hypothesis| hypothesis.is_strong());
        let enough = (COST * 2.0 * strong().count() as f64).ln();
        let search = Search { rounds, poses, held: held(rounds), enough };
        let around = |group| [0, 1].into_iter().find_map(|side| search.around(group, side));
        steps = strong().filter_map(around).flatten().collect();
    }
    let step = |edge: &Edge| {
        let place = |id| graph.node_index(id).map(|node| rounds.model.chains.places[node]);
        let ((chain, one), (_, other)) = place(edge.from).zip(place(edge.to))?;
        Some(Step { chain, later: one.max(other) })
    };
    let odometry = graph.edges.iter().enumerate().filter(|(_, edge)| edge.kind == EdgeKind::Odometry);
    odometry
        .filter(|(_, edge)| edge.in_use() && step(edge).is_some_and(|step| steps.contains(&step)))
        .map(|(place, _)| place)
        .collect()
}

/// A step of a chain, named by its later position.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Step {
    pub(crate) chain: usize,
    pub(crate) later: usize,
}

/// The positions of each chain where accepted closures end, in order.
fn held<G: Motion<DOF>, const DOF: usize>(rounds: &Rounds<'_, G, DOF>) -> Vec<Vec<usize>> {
    let mut held = vec![Vec::new(); rounds.model.chains.chains.len()];
    for closure in (0..rounds.accepted.len()).filter(|&closure| rounds.accepted[closure]) {
        for side in [0, 1] {
            let (chain, place) = rounds.model.ends(closure)[side];
            held[chain].push(place);
        }
    }
    for places in &mut held {
        places.sort_unstable();
    }
    held
}

struct Search<'a, G, const DOF: usize> {
    rounds: &'a Rounds<'a, G, DOF>,
    poses: &'a [G],
    held: Vec<Vec<usize>>,
    /// Evidence at which less than a third of one group is expected to agree by chance.
    enough: f64,
}

impl<G: Motion<DOF>, const DOF: usize> Search<'_, G, DOF> {
    /// The broken steps around a group's ends in chain A (`side` 0) or B (1), if there are any.
    fn around(&self, hypothesis: &Hypothesis, side: usize) -> Option<Vec<Step>> {
        let end = |closure: usize| self.rounds.model.ends(closure)[side];
        let left_out = self.rounds.left_out(hypothesis)?;
        let mut members: Vec<(usize, usize)> =
            left_out.into_iter().map(|member| (end(member).1, member)).collect();
        members.sort_unstable();
        let (chain, _) = end(hypothesis.members[0]);
        // The stretch without accepted closures around most members. A few members may lie outside it.
        let (middle, all) = (members[members.len() / 2].0, members.len());
        let held = &self.held[chain];
        let next = held.partition_point(|&place| place < middle);
        let (before, after) = (next.checked_sub(1).map(|last| held[last]), held.get(next).copied());
        members.retain(|(place, _)| {
            before.is_none_or(|before| *place > before) && after.is_none_or(|after| *place < after)
        });
        if 2 * members.len() <= all {
            return None;
        }
        let (low, high) = (members[0].0, members[members.len() - 1].0);
        let closures = || members.iter().map(|(_, member)| *member);
        let mut steps = Vec::new();
        if let Some(before) = before
            && self.is_usual((chain, side), [before, low], closures().take(WITNESSES))
        {
            steps.push(Step { chain, later: low });
        }
        if let Some(after) = after
            && self.is_usual((chain, side), [after, high], closures().rev().take(WITNESSES))
        {
            steps.push(Step { chain, later: high + 1 });
        }
        (!steps.is_empty()).then_some(steps)
    }

    /// Whether the usual motion explains most members better than chance: the robot moves from an accepted position to theirs.
    fn is_usual(
        &self,
        (chain, side): (usize, usize),
        [from, to]: [usize; 2],
        members: impl Iterator<Item = usize>,
    ) -> bool {
        let model = self.rounds.model;
        let Some((mean, covariance)) = motion_over(&model.chains.chains, chain, [from, to]) else {
            return false;
        };
        let (mut fit, mut all) = (0, 0);
        for member in members {
            all += 1;
            let (motion, own) = self.motion(side, [from, to], member);
            let apart = model.apart_local(member);
            let error = mean.between(&motion).log();
            let found = compare(&error, &(covariance + own), &apart, &apart, self.rounds.random.tail);
            fit += usize::from(found.is_some_and(|found| found.distant() > self.enough));
        }
        2 * fit > all
    }

    /// The motion between two positions of a chain: the first as in the map, the second where a closure puts it. Its
    /// covariance is twice that of the measurement, because the map's own errors are about as large at accepted positions,
    /// plus that of the odometry from the closure's end to the second position.
    fn motion(&self, side: usize, [from, to]: [usize; 2], closure: usize) -> (G, SMatrix<f64, DOF, DOF>) {
        let (model, factors) = (self.rounds.model, &self.rounds.random);
        let edge = self.rounds.drawing.landmark(closure);
        let (chain, place) = model.ends(closure)[side];
        let covariance = model.measurement_covariance(&model.closures[closure]);
        // The edge may point either way.
        let (end, covariance) = if model.chains.places[edge.to] == (chain, place) {
            (self.poses[edge.from].compose(&edge.measurement), covariance)
        } else {
            let back = edge.measurement.inverse();
            (self.poses[edge.to].compose(&back), inverse(&edge.measurement, &covariance))
        };
        let odometry = &model.chains.chains[chain];
        let along = odometry.poses[place].between(&odometry.poses[to]);
        let own = to_body(&along, &(covariance * (2.0 * factors.landmark)))
            + to_body(
                &odometry.poses[to],
                &(odometry.covariance_between(place, to) * factors.odometry[chain]),
            );
        (self.poses[model.node(chain, from)].between(&end.compose(&along)), own)
    }
}

/// Mean and covariance of the motion over as many steps in the same direction, anywhere on the chain, or on all chains if it
/// is too short.
fn motion_over<G: Motion<DOF>, const DOF: usize>(
    chains: &[Chain<G, DOF>],
    own: usize,
    [from, to]: [usize; 2],
) -> Option<(G, SMatrix<f64, DOF, DOF>)> {
    let length = from.abs_diff(to);
    if !(1..=LONGEST).contains(&length) {
        return None;
    }
    let over = |chains: &[Chain<G, DOF>]| {
        let motions: Vec<SVector<f64, DOF>> = stretches(chains, length)
            .map(|(one, other)| if from < to { one.between(other).log() } else { other.between(one).log() })
            .collect();
        usual_motion(&motions)
    };
    over(&chains[own..=own]).or_else(|| over(chains))
}

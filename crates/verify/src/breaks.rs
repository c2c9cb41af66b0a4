//! Where the odometry of a chain is broken.
//!
//! Wheels slip and robots are turned by hand: a step or two are wrong beyond all claims, and what lies behind them contradicts the map,
//! correct as it is. False edges that agree with each other contradict it, too. What tells them apart is the motion that they make
//! of the broken steps: correct ones have the robot move as it usually does, false ones have it jump anywhere.

use nalgebra::{SMatrix, SVector};
use posecut_graph::{Edge, EdgeKind, PoseGraph};
use posecut_pcm::chain::Chain;

use crate::cut::COST;
use crate::evidence::compare;
use crate::islands::Hypothesis;
use crate::map::Drawing;
use crate::model::{Model, Motion};
use crate::rounds::Rounds;

/// Members of a group next to a break that are looked at.
const WITNESSES: usize = 9;
/// Most steps that a break may have: over more of them, chance is as near as the usual motion.
const LONGEST: usize = 10;
/// Fewest motions that tell the usual one.
const MOTIONS: usize = 20;

/// The places among the graph's edges of the odometry before and after groups that the map does not support, where these lie on
/// stretches of a chain of which the map holds nothing, and the robot gets there as it usually moves.
pub(crate) fn breaks<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    rounds: &Rounds<'_, G, DOF>,
) -> Vec<usize> {
    let Some(poses) = &rounds.poses else { return Vec::new() };
    // Each group is looked at from both sides.
    let enough = (COST * 2.0 * rounds.hypotheses.len() as f64).ln();
    let search =
        Search { rounds, model: rounds.model, drawing: &rounds.drawing, poses, held: held(rounds), enough };
    let mut steps: Vec<Step> = Vec::new();
    for hypothesis in &rounds.hypotheses {
        let found = [0, 1].into_iter().find_map(|side| search.around(hypothesis, side));
        steps.extend(found.into_iter().flatten());
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

/// A step of a chain, by its later place.
#[derive(Clone, Copy, PartialEq)]
struct Step {
    chain: usize,
    later: usize,
}

/// The places of each chain that accepted closures lead from or to, in order.
fn held<G: Motion<DOF>, const DOF: usize>(rounds: &Rounds<'_, G, DOF>) -> Vec<Vec<usize>> {
    let mut held = vec![Vec::new(); rounds.model.chains.chains.len()];
    for closure in (0..rounds.accepted.len()).filter(|&closure| rounds.accepted[closure]) {
        for side in [0, 1] {
            let (chain, place) = end(rounds.model, closure, side);
            held[chain].push(place);
        }
    }
    for places in &mut held {
        places.sort_unstable();
    }
    held
}

/// Chain and place of a closure's end in chain A (side 0) or B.
fn end<G: Motion<DOF>, const DOF: usize>(
    model: &Model<G, DOF>,
    closure: usize,
    side: usize,
) -> (usize, usize) {
    let (span, candidate) = (model.span(closure), &model.closures[closure].candidate);
    [(span.a, candidate.i), (span.b, candidate.k)][side]
}

struct Search<'a, G, const DOF: usize> {
    rounds: &'a Rounds<'a, G, DOF>,
    model: &'a Model<G, DOF>,
    drawing: &'a Drawing<G, DOF>,
    poses: &'a [G],
    held: Vec<Vec<usize>>,
    /// Evidence at which fewer than a third of a group is expected to be there by chance.
    enough: f64,
}

impl<G: Motion<DOF>, const DOF: usize> Search<'_, G, DOF> {
    /// The broken steps around a group's ends on one side, if there are any.
    fn around(&self, hypothesis: &Hypothesis, side: usize) -> Option<Vec<Step>> {
        // Judged by the map, and not accepted.
        let left_out =
            |member: &usize| !self.rounds.accepted[*member] && self.rounds.ratio[*member].is_some();
        let mut members: Vec<(usize, usize)> = hypothesis
            .members
            .iter()
            .filter(|member| left_out(member))
            .map(|&member| (end(self.model, member, side).1, member))
            .collect();
        if 2 * members.len() <= hypothesis.members.len() {
            return None;
        }
        members.sort_unstable();
        let (chain, _) = end(self.model, hypothesis.members[0], side);
        // The stretch without accepted closures around most members; a few may lie beside it.
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
        let near =
            |members: Vec<(usize, usize)>| members.into_iter().take(WITNESSES).map(|(_, member)| member);
        let mut steps = Vec::new();
        if let Some(before) = before {
            self.usual(chain, side, [before, low], near(members.clone()))?;
            steps.push(Step { chain, later: low });
        }
        if let Some(after) = after {
            members.reverse();
            self.usual(chain, side, [after, high], near(members))?;
            steps.push(Step { chain, later: high + 1 });
        }
        (!steps.is_empty()).then_some(steps)
    }

    /// Something, where most members have the robot move from a place that the map holds to theirs as it usually moves.
    fn usual(
        &self,
        chain: usize,
        side: usize,
        [from, to]: [usize; 2],
        members: impl Iterator<Item = usize>,
    ) -> Option<()> {
        let (mean, covariance) = usual_motion(&self.model.chains.chains, chain, [from, to])?;
        let (mut fit, mut all) = (0, 0);
        for member in members {
            let error = mean.between(&self.motion(chain, side, [from, to], member)).log();
            let covariance = covariance + self.uncertainty(chain, side, to, member);
            let apart = self.model.apart_local(member);
            let found = compare(&error, &covariance, &apart, &apart, self.rounds.random.tail);
            all += 1;
            fit += usize::from(found.is_some_and(|found| {
                found.squared_distance <= self.rounds.usual && found.distant() > self.enough
            }));
        }
        (2 * fit > all).then_some(())
    }

    /// The motion between two places of a chain, the first where the map has it, the second where a closure puts it.
    fn motion(&self, chain: usize, side: usize, [from, to]: [usize; 2], closure: usize) -> G {
        let edge = self.drawing.landmark(closure);
        // The edge may lead either way.
        let forward = self.model.chains.places[edge.to] == end(self.model, closure, side);
        let own = if forward {
            self.poses[edge.from].compose(&edge.measurement)
        } else {
            self.poses[edge.to].compose(&edge.measurement.inverse())
        };
        let odometry = &self.model.chains.chains[chain].poses;
        let (_, place) = end(self.model, closure, side);
        let there = own.compose(&odometry[place].between(&odometry[to]));
        self.poses[self.model.node(chain, from)].between(&there)
    }

    /// The covariance of that motion without the usual one's: of the measurement, twice, since the map's own errors are about as large
    /// where it holds a place, and of the odometry from the closure's end to the place.
    fn uncertainty(&self, chain: usize, side: usize, to: usize, closure: usize) -> SMatrix<f64, DOF, DOF> {
        let (factors, odometry) = (&self.rounds.random, &self.model.chains.chains[chain]);
        let (_, place) = end(self.model, closure, side);
        let local = |covariance: SMatrix<f64, DOF, DOF>, frame: G| {
            let turned = frame.adjoint();
            turned * covariance * turned.transpose()
        };
        let measured = self.model.measurement_covariance(&self.model.closures[closure]);
        let along = odometry.covariance_between(place, to) * factors.odometry[chain];
        local(measured * (2.0 * factors.landmark), odometry.poses[to].between(&odometry.poses[place]))
            + local(along, odometry.poses[to].inverse())
    }
}

/// Mean and covariance of the motion over as many steps in the same direction: anywhere on a chain, or on all where it is short.
fn usual_motion<G: Motion<DOF>, const DOF: usize>(
    chains: &[Chain<G, DOF>],
    own: usize,
    [from, to]: [usize; 2],
) -> Option<(G, SMatrix<f64, DOF, DOF>)> {
    let length = from.abs_diff(to);
    if !(1..=LONGEST).contains(&length) {
        return None;
    }
    let chains = if chains[own].poses.len() < length + MOTIONS { chains } else { &chains[own..=own] };
    let motions: Vec<SVector<f64, DOF>> = chains
        .iter()
        .flat_map(|chain| chain.poses.iter().zip(chain.poses.iter().skip(length)))
        .map(|(one, other)| if from < to { one.between(other).log() } else { other.between(one).log() })
        .collect();
    if motions.len() < MOTIONS {
        return None;
    }
    let count = motions.len() as f64;
    let mean = motions.iter().sum::<SVector<f64, DOF>>() / count;
    let scatter: SMatrix<f64, DOF, DOF> =
        motions.iter().map(|motion| (motion - mean) * (motion - mean).transpose()).sum();
    Some((G::exp(&mean), scatter / count))
}

//! Broken steps of odometry that no accepted loop spans, however far they are from the edges that show them.
//!
//! Where a robot slips, edges between the time before and the time after contradict odometry, all by the same motion, and are rejected
//! together. A group of rejected edges says which motion each open step between its ends has if that step alone is broken. For the step where
//! the robot slipped, this is a step such as the robot takes elsewhere; for other steps, and for groups of false edges, it is a jump.

use std::collections::BTreeMap;
use std::slice;

use nalgebra::SMatrix;
use posecut_geometry::covariance::to_body;
use rayon::prelude::*;

use crate::breaks::Step;
use crate::cut::COST;
use crate::evidence::CLIP;
use crate::islands::spread;
use crate::model::Motion;
use crate::rounds::Rounds;
use crate::spans::Spans;
use crate::usual::UsualStep;

/// Members of a group that are examined.
const WITNESSES: usize = 9;
/// Groups that are examined, the heaviest first.
const GROUPS: usize = 50;

/// The steps that groups of rejected edges show to be broken. Takes O([`GROUPS`] x [`WITNESSES`] x open steps).
pub(crate) fn slips<G: Motion<DOF>, const DOF: usize>(rounds: &Rounds<'_, G, DOF>, poses: &[G]) -> Vec<Step> {
    let strong = rounds.hypotheses.iter().filter(|hypothesis| hypothesis.is_strong()).take(GROUPS);
    let groups: Vec<Group> = strong
        .enumerate()
        .filter_map(|(rank, group)| {
            Some(Group { witnesses: spread(&rounds.left_out(group)?, WITNESSES), rank })
        })
        .collect();
    if groups.is_empty() {
        return Vec::new();
    }
    let chains = &rounds.model.chains.chains;
    let of_all = UsualStep::of(chains);
    let usual = chains.iter().map(|chain| UsualStep::of(slice::from_ref(chain)));
    // Of all chains where one is short.
    let usual = usual.map(|usual| usual.or_else(|| of_all.clone())).collect();
    let search = Search { rounds, poses, spans: Spans::of(rounds), usual };
    let mut suspects: Vec<Vec<Suspect>> = groups.par_iter().map(|group| search.suspects(group)).collect();
    let mut found = Vec::new();
    while let Some(step) = most_suspected(&suspects) {
        found.push(step);
        // Groups that this step explains say nothing about others.
        suspects.retain(|suspects| suspects.iter().all(|suspect| suspect.step != step));
    }
    found
}

/// A group of which most members are rejected.
struct Group {
    witnesses: Vec<usize>,
    /// The number of heavier groups.
    rank: usize,
}

/// A step that may be broken.
#[derive(Clone, Copy)]
struct Suspect {
    step: Step,
    /// A group's evidence for it, beyond what chance gives the best step of some group. Positive.
    evidence: f64,
}

/// The step with the most evidence, summed over groups, if it is enough.
fn most_suspected(suspects: &[Vec<Suspect>]) -> Option<Step> {
    let mut sums: BTreeMap<Step, f64> = BTreeMap::new();
    for &Suspect { step, evidence } in suspects.iter().flatten() {
        *sums.entry(step).or_default() += evidence;
    }
    let (step, evidence) = sums.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    // Less than a third of a step without a slip is expected to have that much by chance, with equal odds of a slip and of a false group.
    (evidence > (2.0 * COST).ln()).then_some(step)
}

struct Search<'a, G, const DOF: usize> {
    rounds: &'a Rounds<'a, G, DOF>,
    poses: &'a [G],
    spans: Vec<Spans<DOF>>,
    /// The usual step of each chain, if there are enough steps.
    usual: Vec<Option<UsualStep<G, DOF>>>,
}

impl<G: Motion<DOF>, const DOF: usize> Search<'_, G, DOF> {
    /// The steps that may be broken according to a group.
    fn suspects(&self, Group { witnesses, rank }: &Group) -> Vec<Suspect> {
        let [(a, _), (b, _)] = self.rounds.model.ends(witnesses[0]);
        let mut suspects = Vec::new();
        for chain in [Some(a), (a != b).then_some(b)].into_iter().flatten() {
            let Some(usual) = &self.usual[chain] else { continue };
            for later in self.spans[chain].open_steps() {
                let step = Step { chain, later };
                suspects
                    .extend(self.evidence(witnesses, step, usual).map(|evidence| Suspect { step, evidence }));
            }
        }
        // The best of so many steps, and one of all groups: the expected number of suspects by chance is one at most, since the sum of
        // 1 / (k (k + 1)) over all groups k is one.
        let (steps, rank) = (suspects.len() as f64, *rank as f64);
        let by_chance = (steps * (rank + 1.0) * (rank + 2.0)).ln();
        suspects.retain_mut(|suspect| {
            suspect.evidence -= by_chance;
            suspect.evidence > 0.0
        });
        suspects
    }

    /// The evidence of most witnesses that a step is broken, or any negative one if theirs is negative; `None` if most do not span the step.
    fn evidence(&self, witnesses: &[usize], step: Step, usual: &UsualStep<G, DOF>) -> Option<f64> {
        let model = self.rounds.model;
        let spanning: Vec<_> = witnesses
            .iter()
            .filter_map(|&witness| self.sides(witness, step).map(|sides| (witness, sides)))
            .collect();
        if 2 * spanning.len() <= witnesses.len() {
            return None;
        }
        let (mut evidence, mut against) = (Vec::with_capacity(spanning.len()), 0);
        for &(witness, sides) in &spanning {
            let (motion, own) = self.needed(witness, step, sides);
            let apart = model.apart_local(witness);
            evidence.push(usual.evidence(&motion, &own, &apart, self.rounds.random.tail));
            against += usize::from(evidence[evidence.len() - 1] < 0.0);
            if 2 * against > spanning.len() {
                return Some(-CLIP);
            }
        }
        evidence.sort_by(f64::total_cmp);
        Some(evidence[(evidence.len() - 1) / 2])
    }

    /// The motion over a step if this closure is correct and the step alone is broken, and its covariance in the frame of the step's end.
    fn needed(
        &self,
        closure: usize,
        step: Step,
        [before, after]: [(usize, usize); 2],
    ) -> (G, SMatrix<f64, DOF, DOF>) {
        let (model, factors) = (self.rounds.model, &self.rounds.random);
        let node = |(chain, place): (usize, usize)| model.node(chain, place);
        let pose = |place: usize| self.poses[model.node(step.chain, place)];
        let edge = self.rounds.drawing.landmark(closure);
        let is_forward = edge.from == node(before);
        let measured = if is_forward { edge.measurement } else { edge.measurement.inverse() };
        let there = pose(step.later - 1).between(&self.poses[node(before)]);
        let back = self.poses[node(after)].between(&pose(step.later));
        let motion = there.compose(&measured).compose(&back);
        // The map's own errors are about as large as those of the measurement.
        let covariance = model.measurement_covariance(&model.closures[closure]) * (2.0 * factors.landmark);
        let to_end = if is_forward { back } else { measured.compose(&back) };
        let mut own = to_body(&to_end, &covariance);
        let odometry = &model.chains.chains[step.chain];
        let spans = &self.spans[step.chain];
        if after.0 == step.chain {
            let along = spans.covariance_between(step.later, after.1);
            own += to_body(&odometry.poses[step.later], &along);
        }
        if before.0 == step.chain {
            let along = spans.covariance_between(before.1, step.later - 1);
            own += to_body(&motion, &to_body(&odometry.poses[step.later - 1], &along));
        }
        (motion, own)
    }

    /// A closure's ends, that before the step first; `None` if it does not span the step. In another chain, an end is on the side of the
    /// positions where accepted closures join the two.
    fn sides(&self, closure: usize, Step { chain, later }: Step) -> Option<[(usize, usize); 2]> {
        let [one, other] = self.rounds.model.ends(closure);
        if one.0 == other.0 {
            let [before, after] = if one.1 < other.1 { [one, other] } else { [other, one] };
            return (before.1 < later && later <= after.1).then_some([before, after]);
        }
        let (own, far) = if one.0 == chain { (one, other) } else { (other, one) };
        let (first, last) = self.spans[chain].joined?;
        if own.1 < later && later <= first {
            Some([own, far])
        } else if last < later && later <= own.1 {
            Some([far, own])
        } else {
            None
        }
    }
}

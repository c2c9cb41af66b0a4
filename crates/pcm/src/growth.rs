//! Growth: candidates that the clique lost by a pair or two.

use rayon::prelude::*;

use crate::Gate;
use crate::chance::{Chance, acceptable};
use crate::consistency::{PairCounts, Pairs};
use crate::nearest::Nearest;
use crate::spread::Spatial;

/// Members that a candidate is held against.
const WITNESSES: usize = 8;
/// How many of them must agree, of four.
const QUARTERS: usize = 3;
/// With fewer members there is nothing to hold a candidate against.
const FEWEST: usize = 3;

/// What grew.
#[derive(Clone, Debug, Default)]
pub struct Growth {
    /// The candidates that join, ascending.
    pub grown: Vec<usize>,
    /// Candidates that agree with members, but no better than chance, ascending.
    pub by_chance: Vec<usize>,
    /// Each of both with the false alarms that it would cause; none where covariances are not looked at.
    pub false_alarms: Vec<(usize, f64)>,
    /// How the pairs fared.
    pub counts: PairCounts,
}

/// The candidates outside `members` that agree with three quarters of the eight members nearest to them by distance
/// travelled, and not by chance: a wrong one weighs as much as `cost` correct ones.
///
/// Near members say most: the odometry between adds little to the covariance. Far from all members nearly everything
/// agrees; there [`Chance`] has to say. The members are not extended meanwhile: what grows does not depend on the order.
/// O(N log N) time, 8 N pairs.
pub fn grow<G: Spatial<DOF>, const DOF: usize>(
    pairs: &Pairs<'_, G, DOF>,
    members: &[usize],
    gate: Gate,
    cost: f64,
) -> Growth {
    let mut growth = Growth::default();
    if members.len() < FEWEST {
        return growth;
    }
    let nearest = Nearest::new(pairs, members);
    // Where covariances are not looked at, nothing tells what chance can do.
    let chance = gate.per_step.is_none().then(|| Chance::new(pairs));
    let mut inside = vec![false; pairs.len()];
    for &member in members {
        inside[member] = true;
    }
    let verdicts: Vec<(Option<f64>, PairCounts)> = (0..pairs.len())
        .into_par_iter()
        .map(|candidate| {
            let mut counts = PairCounts::default();
            if inside[candidate] || !pairs.agrees_with_odometry(candidate, gate) {
                return (None, counts);
            }
            let mut witnesses = nearest.of(pairs.position(candidate), candidate, WITNESSES);
            let asked = witnesses.len();
            witnesses.retain(|&member| pairs.consistent(candidate, member, gate, &mut counts));
            let expected =
                || chance.as_ref().map_or(0.0, |chance| chance.false_alarms(candidate, &witnesses));
            ((4 * witnesses.len() >= QUARTERS * asked).then(expected), counts)
        })
        .collect();
    let agreeing: Vec<(usize, f64)> = verdicts
        .iter()
        .enumerate()
        .filter_map(|(candidate, verdict)| Some((candidate, verdict.0?)))
        .collect();
    let limit = acceptable(agreeing.iter().map(|&(_, expected)| expected).collect(), cost);
    for &(candidate, expected) in &agreeing {
        let list = if expected <= limit { &mut growth.grown } else { &mut growth.by_chance };
        list.push(candidate);
    }
    for (_, counts) in verdicts {
        growth.counts += counts;
    }
    if chance.is_some() {
        growth.false_alarms = agreeing;
    }
    growth
}

//! Growth: candidates that are missing from the clique because of a pair or two.

use rayon::prelude::*;

use crate::Gate;
use crate::chance::{Acceptance, acceptable};
use crate::odometry::spread::Spatial;
use crate::pairs::consistency::{PairCounts, Pairs};
use crate::pairs::nearest::Nearest;

/// The number of members that a candidate is tested against: enough that one or two wrong ones do not decide.
const WITNESSES: usize = 8;
/// How many of every four members must agree. At a loose gate a correct candidate hardly ever disagrees with a correct
/// member, but some of the members may be wrong.
const QUARTERS: usize = 3;
/// The fewest members for growth: fewer are not enough to test a candidate against.
const FEWEST: usize = 3;

/// The result of growth.
#[derive(Clone, Debug, Default)]
pub struct Growth {
    /// The candidates that join, ascending.
    pub grown: Vec<usize>,
    /// Candidates that agree with members, but no better than chance, ascending.
    pub by_chance: Vec<usize>,
    /// The candidates of both lists, each with the false alarms that it would cause; empty if covariances are not used.
    pub false_alarms: Vec<(usize, f64)>,
    /// Candidates that agree with some member near them but do not join, ascending. More members may change that.
    pub open: Vec<usize>,
    /// The numbers of pairs by result.
    pub counts: PairCounts,
}

/// Finds the candidates outside `members` that agree with three quarters of the eight members nearest to them by distance
/// travelled, and that agree better than by chance, according to `acceptance`.
///
/// Near members are the best witnesses, because the odometry between adds little to the covariance. Far from all members
/// nearly everything agrees, and [`chance`](crate::chance) must decide. The members stay fixed during growth, so that the
/// result does not depend on the order. O(N log N) time, 8 N pairs.
pub fn grow<G: Spatial<DOF>, const DOF: usize>(
    pairs: &Pairs<'_, G, DOF>,
    members: &[usize],
    gate: Gate,
    acceptance: Acceptance<DOF>,
) -> Growth {
    let everyone: Vec<usize> = (0..pairs.len()).collect();
    grow_among(pairs, members, &everyone, gate, acceptance)
}

/// As [`grow`], but only for the given candidates, in ascending order.
pub(crate) fn grow_among<G: Spatial<DOF>, const DOF: usize>(
    pairs: &Pairs<'_, G, DOF>,
    members: &[usize],
    asked: &[usize],
    gate: Gate,
    acceptance: Acceptance<DOF>,
) -> Growth {
    let mut growth = Growth::default();
    if members.len() < FEWEST {
        return growth;
    }
    let nearest = Nearest::new(pairs, members);
    // Without covariances there is no measure of agreement by chance.
    let chance = gate.per_step.is_none().then(|| acceptance.chance(pairs));
    let mut inside = vec![false; pairs.len()];
    for &member in members {
        inside[member] = true;
    }
    let verdicts: Vec<(Verdict, PairCounts)> = asked
        .par_iter()
        .map(|&candidate| {
            let mut counts = PairCounts::default();
            if inside[candidate] || !pairs.agrees_with_odometry(candidate, gate) {
                return (Verdict::No, counts);
            }
            let near = nearest.of(pairs.position(candidate), candidate, WITNESSES);
            let mut witnesses = Vec::with_capacity(near.len());
            for (place, &member) in near.iter().enumerate() {
                // So many have disagreed that three quarters can no longer agree.
                if 4 * (place - witnesses.len()) > (4 - QUARTERS) * near.len() {
                    break;
                }
                if pairs.consistent(candidate, member, gate, &mut counts) {
                    witnesses.push(member);
                }
            }
            let verdict = if witnesses.is_empty() {
                Verdict::No
            } else if 4 * witnesses.len() < QUARTERS * near.len() {
                Verdict::Open
            } else {
                Verdict::Agrees(
                    chance.as_ref().map_or(0.0, |chance| chance.false_alarms(candidate, &witnesses)),
                )
            };
            (verdict, counts)
        })
        .collect();
    // One limit for all candidates, because each one that joins adds to the false alarms of the whole.
    let alarms = |&(verdict, _): &(Verdict, PairCounts)| match verdict {
        Verdict::Agrees(expected) => Some(expected),
        _ => None,
    };
    let limit = acceptable(verdicts.iter().filter_map(alarms).collect(), acceptance.cost);
    for (&candidate, (verdict, counts)) in asked.iter().zip(verdicts) {
        growth.counts += counts;
        match verdict {
            Verdict::No => continue,
            Verdict::Open => growth.open.push(candidate),
            Verdict::Agrees(expected) if expected <= limit => growth.grown.push(candidate),
            Verdict::Agrees(_) => {
                growth.by_chance.push(candidate);
                growth.open.push(candidate);
            }
        }
        if let (Verdict::Agrees(expected), true) = (verdict, chance.is_some()) {
            growth.false_alarms.push((candidate, expected));
        }
    }
    growth
}

/// The result of testing a candidate against the members near it.
#[derive(Clone, Copy)]
enum Verdict {
    /// None agreed before too many disagreed.
    No,
    /// Some agree, but too few.
    Open,
    /// Enough agree. The candidate would cause this many false alarms.
    Agrees(f64),
}

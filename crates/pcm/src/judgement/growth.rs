//! Growth: candidates that the clique lost by a pair or two.

use rayon::prelude::*;

use crate::Gate;
use crate::chance::{Acceptance, acceptable};
use crate::odometry::spread::Spatial;
use crate::pairs::consistency::{PairCounts, Pairs};
use crate::pairs::nearest::Nearest;

/// Members that a candidate is held against: enough that one or two wrong ones do not decide.
const WITNESSES: usize = 8;
/// How many of them must agree, of four: at a loose gate a correct candidate hardly disagrees with a correct member, but some of the
/// members may be wrong.
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
    /// Candidates that agree with some member near them and do not join, ascending: more members may change that.
    pub open: Vec<usize>,
    /// How the pairs fared.
    pub counts: PairCounts,
}

/// The candidates outside `members` that agree with three quarters of the eight members nearest to them by distance
/// travelled, and not by chance, as `acceptance` says.
///
/// Near members say most: the odometry between adds little to the covariance. Far from all members nearly everything
/// agrees; there [`chance`](crate::chance) has to say. The members are not extended meanwhile: what grows does not depend on the order.
/// O(N log N) time, 8 N pairs.
pub fn grow<G: Spatial<DOF>, const DOF: usize>(
    pairs: &Pairs<'_, G, DOF>,
    members: &[usize],
    gate: Gate,
    acceptance: Acceptance<DOF>,
) -> Growth {
    let everyone: Vec<usize> = (0..pairs.len()).collect();
    grow_among(pairs, members, &everyone, gate, acceptance)
}

/// As [`grow`], of these candidates alone, which ascend.
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
    // Where covariances are not looked at, nothing tells what chance can do.
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
                // Too many have disagreed for three quarters still to agree.
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
    // The limit is that of all candidates together, since each that grows adds to the false alarms of the whole.
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

/// What the members near a candidate say of it.
#[derive(Clone, Copy)]
enum Verdict {
    /// None agrees before too many disagree.
    No,
    /// Some agree, and too few.
    Open,
    /// Enough agree; so many false alarms it would cause.
    Agrees(f64),
}

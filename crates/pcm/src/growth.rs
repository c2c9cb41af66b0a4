//! Growth: candidates that the clique lost by a pair or two.

use rayon::prelude::*;

use crate::Gate;
use crate::consistency::{PairCounts, Pairs};
use crate::nearest::Nearest;
use crate::spread::Spatial;

/// Members that a candidate is held against, of each kind.
const WITNESSES: usize = 8;
/// How many of each kind must agree, of four.
const QUARTERS: usize = 3;
/// With fewer members there is nothing to hold a candidate against.
const FEWEST: usize = 3;

/// The candidates outside `members` that agree with three quarters of the eight members nearest to them by distance
/// travelled in both chains, and of the eight nearest in either chain alone, ascending.
///
/// Near members say most: the odometry between adds little to the covariance. A candidate between places that no member
/// joins has only far members in both chains; those near its one end and those near its other make two loops of
/// different odometry.
///
/// The members are not extended meanwhile: what grows does not depend on the order. O(24 N) pairs.
pub fn grow<G: Spatial<DOF>, const DOF: usize>(
    pairs: &Pairs<'_, G, DOF>,
    members: &[usize],
    gate: Gate,
) -> (Vec<usize>, PairCounts) {
    let mut total = PairCounts::default();
    if members.len() < FEWEST {
        return (Vec::new(), total);
    }
    let nearest = [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(|weights| Nearest::new(pairs, members, weights));
    let mut inside = vec![false; pairs.len()];
    for &member in members {
        inside[member] = true;
    }
    let verdicts: Vec<(bool, PairCounts)> = (0..pairs.len())
        .into_par_iter()
        .map(|candidate| {
            let mut counts = PairCounts::default();
            if inside[candidate] || !pairs.agrees_with_odometry(candidate, gate) {
                return (false, counts);
            }
            let joins = nearest.iter().all(|nearest| {
                let witnesses = nearest.of(pairs.position(candidate), candidate, WITNESSES);
                let agree = witnesses
                    .iter()
                    .filter(|&&member| pairs.consistent(candidate, member, gate, &mut counts))
                    .count();
                4 * agree >= QUARTERS * witnesses.len()
            });
            (joins, counts)
        })
        .collect();
    let mut grown = Vec::new();
    for (candidate, (joins, counts)) in verdicts.into_iter().enumerate() {
        total += counts;
        if joins {
            grown.push(candidate);
        }
    }
    (grown, total)
}

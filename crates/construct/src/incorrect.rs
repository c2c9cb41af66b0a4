//! Pairs of viewpoints that a place recogniser takes for the same place by mistake.

use std::collections::HashSet;

use rand::Rng;
use rand::RngExt as _;

use crate::landmark::Viewpoint;
use crate::{ConstructError, Options};

/// Draws a wanted pair may cost before the request counts as impossible.
const DRAWS_PER_PAIR: usize = 1000;

/// How many incorrect edges make the given share of all landmark edges: `correct * rate / (1 - rate)`.
pub(crate) fn count(correct: usize, rate: f64) -> usize {
    (correct as f64 * rate / (1.0 - rate)).round() as usize
}

/// Different pairs of viewpoints of different experiences, uniform over those further apart than asked for.
pub(crate) fn random_pairs(
    viewpoints: &[Viewpoint],
    wanted: usize,
    options: &Options,
    random: &mut impl Rng,
) -> Result<Vec<(usize, usize)>, ConstructError> {
    let mut chosen = HashSet::new();
    let mut pairs = Vec::with_capacity(wanted);
    let most = wanted.saturating_mul(DRAWS_PER_PAIR);
    for _ in 0..most {
        if pairs.len() == wanted {
            break;
        }
        let (one, other) =
            (random.random_range(0..viewpoints.len()), random.random_range(0..viewpoints.len()));
        let pair = if viewpoints[one].experience < viewpoints[other].experience {
            (one, other)
        } else {
            (other, one)
        };
        let (from, to) = (&viewpoints[pair.0], &viewpoints[pair.1]);
        let wrong = from.experience != to.experience && from.distance(to) > options.incorrect_distance;
        if wrong && chosen.insert(pair) {
            pairs.push(pair);
        }
    }
    if pairs.len() < wanted {
        return Err(ConstructError::TooFewWrongPairs {
            rate: options.incorrect_rate,
            wanted,
            found: pairs.len(),
            distance: options.incorrect_distance,
            attempts: most,
        });
    }
    Ok(pairs)
}

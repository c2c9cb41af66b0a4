//! The index of keys: nearest neighbours in Euclidean distance.
//!
//! Keys are in groups around centres (k-means), and a query looks into the groups whose centres are nearest (an inverted file: Jégou,
//! Douze, Schmid, *Product quantization for nearest neighbor search*, PAMI 33(1), 2011). There are about twice as many groups as the root
//! of the number of keys, and the number that a query looks into grows with the root of that, so that it takes O(n^3/4) of n keys. A tree
//! would give exact answers, but a dozen splits leave nothing out of 30 coordinates: a k-d tree took as long as a search of all keys. Few
//! keys are searched as a whole.

use posecut_random::random;
use rayon::prelude::*;

use crate::k_means;
use crate::polar_context::KEY;

/// A key of a place.
pub type Key = [f64; KEY];

/// Up to this number of keys, a query searches all. Groups are no faster below, and logs of a building have fewer.
pub const SEARCHED: usize = 4096;
/// Groups for each root of the number of keys.
const GROUPS: f64 = 2.0;
/// Groups that a query looks into, for each root of the number of groups.
const VISITED: f64 = 1.5;
/// Keys of each group from which the centres are learnt, and rounds of k-means.
const LEARNT: usize = 32;
const ROUNDS: usize = 8;

/// Keys with an index.
pub struct Keys {
    all: Vec<Key>,
    /// One group around the origin where all keys are searched.
    centres: Vec<[f32; KEY]>,
    /// The positions of the keys of each group, ascending.
    groups: Vec<Vec<usize>>,
    /// Groups that a query looks into.
    visited: usize,
}

impl Keys {
    /// Indexes keys. O(n^3/2).
    pub fn new(keys: Vec<Key>) -> Self {
        if keys.len() <= SEARCHED {
            let groups = vec![(0..keys.len()).collect()];
            return Self { all: keys, centres: vec![[0.0; KEY]], groups, visited: 1 };
        }
        let size = (GROUPS * (keys.len() as f64).sqrt()) as usize;
        let rough: Vec<[f32; KEY]> = keys.iter().map(rough).collect();
        let learnt: Vec<&[f32; KEY]> = rough.iter().step_by(keys.len().div_ceil(size * LEARNT)).collect();
        let centres = k_means::centres(&learnt, size, ROUNDS, &mut random(1, "index of keys"));
        let group: Vec<usize> = rough.par_iter().map(|key| k_means::nearest(&centres, key).0).collect();
        let mut groups = vec![Vec::new(); centres.len()];
        for (position, group) in group.into_iter().enumerate() {
            groups[group].push(position);
        }
        let visited = (VISITED * (centres.len() as f64).sqrt()).ceil() as usize;
        Self { all: keys, centres, groups, visited }
    }

    /// The positions of keys that are nearest to the one at a position, at most `most` of those that are `elsewhere`, with squared
    /// distances: the nearest first, of equal ones the first. Exact for up to [`SEARCHED`] keys; of more, a few in a hundred may be
    /// others that are nearly as near. O(n^3/4).
    pub fn nearest(
        &self,
        position: usize,
        most: usize,
        elsewhere: impl Fn(usize) -> bool,
    ) -> Vec<(f64, usize)> {
        let key = &self.all[position];
        let mut found: Vec<(f64, usize)> = Vec::new();
        for (visits, group) in self.order(key).enumerate() {
            // Where most of the nearest are not elsewhere, the query goes on until it has enough.
            if visits >= self.visited && found.len() >= most {
                break;
            }
            let others = self.groups[group].iter().copied().filter(|other| elsewhere(*other));
            found.extend(others.map(|other| (squared(key, &self.all[other]), other)));
        }
        let order =
            |one: &(f64, usize), other: &(f64, usize)| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1));
        if found.len() > most {
            found.select_nth_unstable_by(most, order);
            found.truncate(most);
        }
        found.sort_unstable_by(order);
        found
    }

    /// The groups, those with the nearest centres first.
    fn order(&self, key: &Key) -> impl Iterator<Item = usize> {
        let key = rough(key);
        let mut distances: Vec<(f32, usize)> = self
            .centres
            .iter()
            .enumerate()
            .map(|(group, centre)| (k_means::squared(centre, &key), group))
            .collect();
        distances.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        distances.into_iter().map(|(_, group)| group)
    }
}

/// A key with less precision, which is enough to group it.
fn rough(key: &Key) -> [f32; KEY] {
    key.map(|number| number as f32)
}

fn squared(one: &Key, other: &Key) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other) * (one - other)).sum()
}

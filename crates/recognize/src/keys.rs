//! The index of keys: nearest neighbours in Euclidean distance.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use crate::polar_context::KEY;

/// A key of a place.
pub type Key = [f64; KEY];

/// Keys with an index.
pub struct Keys {
    keys: Vec<Key>,
    tree: ImmutableKdTree<f64, KEY>,
}

impl Keys {
    /// Indexes keys. O(n log n).
    pub fn new(keys: Vec<Key>) -> Self {
        let tree = ImmutableKdTree::new_from_slice(&keys);
        Self { keys, tree }
    }

    /// The positions of the keys that are nearest to the one at a position, which is among them, with squared distances: the nearest first,
    /// of equal ones the first. A dozen splits leave little out of 30 coordinates, so that this takes nearly as long as a linear search of
    /// 10,000 keys.
    pub fn nearest(&self, position: usize, count: NonZero<usize>) -> Vec<(f64, usize)> {
        let mut found: Vec<(f64, usize)> = self
            .tree
            .nearest_n::<SquaredEuclidean>(&self.keys[position], count)
            .into_iter()
            .map(|neighbour| (neighbour.distance, neighbour.item as usize))
            .collect();
        found.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        found
    }
}

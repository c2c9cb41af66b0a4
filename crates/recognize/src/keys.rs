//! The index of keys: nearest neighbours in Euclidean distance.
//!
//! A k-d tree halves its points along one coordinate a level, and 10,000 points have a dozen levels: of 30 coordinates it uses twelve. The
//! coordinates are therefore turned to the principal axes of the keys, those of the largest variance first. A rotation leaves all distances
//! as they are, and so the answers.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{SMatrix, SVector};

use crate::polar_context::KEY;

/// A key of a place.
pub type Key = [f64; KEY];

/// Keys with an index.
pub struct Keys {
    keys: Vec<Key>,
    /// The same along the principal axes.
    turned: Vec<Key>,
    tree: ImmutableKdTree<f64, KEY>,
}

impl Keys {
    /// Indexes keys. O(n log n).
    pub fn new(keys: Vec<Key>) -> Self {
        let axes = principal_axes(&keys);
        let turned: Vec<Key> = keys.iter().map(|key| (axes * SVector::from(*key)).into()).collect();
        let tree = ImmutableKdTree::new_from_slice(&turned);
        Self { keys, turned, tree }
    }

    /// The positions of the keys that are nearest to the one at a position, which is among them, with squared distances: the nearest first,
    /// of equal ones the first. Expected O(count log n) for keys along few axes.
    pub fn nearest(&self, position: usize, count: NonZero<usize>) -> Vec<(f64, usize)> {
        let here = &self.keys[position];
        let squared = |other: usize| {
            self.keys[other].iter().zip(here).map(|(one, two)| (one - two) * (one - two)).sum()
        };
        let mut found: Vec<(f64, usize)> = self
            .tree
            .nearest_n::<SquaredEuclidean>(&self.turned[position], count)
            .into_iter()
            .map(|neighbour| neighbour.item as usize)
            .map(|other| (squared(other), other))
            .collect();
        found.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        found
    }
}

/// The eigenvectors of the scatter of keys as rows, that of the largest eigenvalue first.
fn principal_axes(keys: &[Key]) -> SMatrix<f64, KEY, KEY> {
    let mean =
        keys.iter().map(|key| SVector::from(*key)).sum::<SVector<f64, KEY>>() / keys.len().max(1) as f64;
    let mut scatter = SMatrix::<f64, KEY, KEY>::zeros();
    for key in keys {
        let off = SVector::from(*key) - mean;
        scatter.ger(1.0, &off, &off, 1.0);
    }
    let eigen = scatter.symmetric_eigen();
    let mut order: Vec<usize> = (0..KEY).collect();
    order.sort_by(|one, other| eigen.eigenvalues[*other].total_cmp(&eigen.eigenvalues[*one]));
    SMatrix::from_fn(|row, column| eigen.eigenvectors[(column, order[row])])
}

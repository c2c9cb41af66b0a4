//! Candidates: keyframes whose surroundings look alike.

use rayon::prelude::*;

use crate::columns::{Columns, heading};
use crate::keys::{Key, Keys};
use crate::polar_context::PolarContext;
use crate::{Routes, Submaps};

/// A descriptor of a place: columns by sector, which another heading shifts, and a key that it leaves as it is.
pub trait Context: Sync {
    /// The key. O(cells).
    fn key(&self) -> Key;

    /// The columns.
    fn columns(&self) -> &Columns;

    /// How alike two contexts are when the other one's sectors are shifted by each number, 0 to 1. O(sectors^2 * rings).
    fn similarities(&self, other: &Self) -> Vec<f64> {
        self.columns().similarities(other.columns())
    }
}

/// The contexts of all keyframes, indexed by their keys.
pub struct Places<C = PolarContext> {
    /// Keyframes with a context.
    nodes: Vec<usize>,
    contexts: Vec<C>,
    keys: Keys,
    /// Keyframes that are less alike are not proposed.
    pub(crate) least_similarity: f64,
}

/// A keyframe that looks like another.
#[derive(Clone, Debug, PartialEq)]
pub struct Resemblance {
    /// The keyframe.
    pub node: usize,
    /// The similarity of the contexts at the best shift, 0 to 1.
    pub similarity: f64,
    /// The headings of the asking keyframe in the frame of this one at which the contexts are most alike, radians, best first.
    pub headings: Vec<f64>,
}

/// Headings that are kept: the best, and others on which the contexts agree nearly as well.
const HEADINGS: usize = 3;
/// A further heading is kept with this share of the best similarity.
const NEARLY: f64 = 0.9;

impl Places<PolarContext> {
    /// Describes keyframes by what was seen within a path length of them, up to a radius, metres. O(keyframes^3/2).
    pub fn new(submaps: &Submaps, nodes: Vec<usize>, length: f64, radius: f64) -> Self {
        let side = radius / 100.0;
        let contexts: Vec<PolarContext> = nodes
            .par_iter()
            .map(|&node| PolarContext::new(&submaps.around(node, length, side), radius))
            .collect();
        Self::of_contexts(nodes, contexts)
    }
}

impl<C: Context> Places<C> {
    /// Indexes keyframes, ascending, by their contexts. O(keyframes^3/2).
    pub fn of_contexts(nodes: Vec<usize>, contexts: Vec<C>) -> Self {
        let keys = Keys::new(contexts.iter().map(C::key).collect());
        Self { nodes, contexts, keys, least_similarity: 0.0 }
    }

    /// The keyframes whose keys are nearest to that of the one at a position, at most `most`, without those within `apart` metres of
    /// it along its route. The nearest first.
    pub fn nearest(&self, position: usize, most: usize, routes: &Routes, apart: f64) -> Vec<usize> {
        let here = self.nodes[position];
        let elsewhere = |other: usize| routes.path_length(here, self.nodes[other]) > apart;
        self.keys.nearest(position, most, elsewhere).iter().map(|(_, other)| *other).collect()
    }

    /// The position of a keyframe among those with a context.
    pub fn position(&self, node: usize) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// How the place at one position looks from the one at another.
    pub fn resemblance(&self, position: usize, other: usize) -> Resemblance {
        let similarities = self.contexts[other].similarities(&self.contexts[position]);
        let count = similarities.len();
        let mut peaks: Vec<usize> = (0..count)
            .filter(|&shift| {
                let value = similarities[shift];
                value >= similarities[(shift + 1) % count]
                    && value > similarities[(shift + count - 1) % count]
            })
            .collect();
        peaks.sort_by(|one, two| similarities[*two].total_cmp(&similarities[*one]).then(one.cmp(two)));
        let best = peaks.first().map_or(0.0, |peak| similarities[*peak]);
        peaks.retain(|peak| similarities[*peak] >= NEARLY * best);
        peaks.truncate(HEADINGS);
        let headings = peaks.into_iter().map(|shift| heading(shift, count)).collect();
        Resemblance { node: self.nodes[other], similarity: best, headings }
    }
}

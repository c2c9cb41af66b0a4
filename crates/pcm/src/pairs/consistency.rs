//! Tests which candidates agree in pairs, and builds the graph of those that do.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use serde::Serialize;

use super::block::{Block, Row};
use super::candidate::{Candidate, Group};
pub use super::distance::{squared_distance, squared_distance_to_odometry};
use super::pretest::{PreTest, Verdict};
use crate::clique::BitGraph;
use crate::odometry::chain::{Chain, Chains};
use crate::odometry::spread::Spatial;
use crate::{Gate, PerStep};
use posecut_geometry::lanes::WIDTH;

/// Blocks of columns that are tested against 64 rows before the next blocks: their data stays in the nearest cache.
const TILE: usize = 4;

/// How many pairs were tested, and with which result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PairCounts {
    /// Pairs tested.
    pub pairs: usize,
    /// Pairs that the pre-test of rotations rejected.
    pub skipped_by_rotation: usize,
    /// Pairs that the pre-test of positions rejected.
    pub skipped_by_translation: usize,
    /// Pairs whose covariance is not positive definite; they are never consistent.
    pub indefinite: usize,
    /// Pairs that are consistent.
    pub consistent: usize,
}

impl std::ops::AddAssign for PairCounts {
    fn add_assign(&mut self, other: Self) {
        self.pairs += other.pairs;
        self.skipped_by_rotation += other.skipped_by_rotation;
        self.skipped_by_translation += other.skipped_by_translation;
        self.indefinite += other.indefinite;
        self.consistent += other.consistent;
    }
}

/// The candidates of a group, with all data that the test of a pair needs.
pub struct Pairs<'a, G, const DOF: usize> {
    pub(crate) chain_a: &'a Chain<G, DOF>,
    pub(crate) chain_b: &'a Chain<G, DOF>,
    pub(crate) same_chain: bool,
    pub(crate) candidates: &'a [Candidate<G, DOF>],
    pretest: PreTest,
    odometry_test: bool,
}

/// Another of `count` candidates, mostly far away. Steps of the golden section spread over all candidates without a
/// pattern.
pub fn elsewhere(count: usize, candidate: usize, turn: usize) -> usize {
    (candidate + (count as f64 * (0.618_034 * turn as f64).fract()) as usize) % count
}

impl<'a, G: Spatial<DOF>, const DOF: usize> Pairs<'a, G, DOF> {
    /// Prepares a group. O(candidates + nodes of both chains).
    pub fn new(chains: &'a Chains<G, DOF>, group: &'a Group<G, DOF>) -> Self {
        Self {
            chain_a: &chains.chains[group.a],
            chain_b: &chains.chains[group.b],
            same_chain: group.a == group.b,
            candidates: &group.candidates,
            pretest: PreTest::new(chains, group),
            odometry_test: true,
        }
    }

    /// The number of candidates.
    pub fn len(&self) -> usize {
        self.candidates.len()
    }

    /// Whether the group has no candidates.
    pub fn is_empty(&self) -> bool {
        self.candidates.is_empty()
    }

    /// The squared Mahalanobis distance of a pair; `None` if its covariance is not positive definite.
    #[inline(always)]
    pub fn squared_distance(&self, one: usize, other: usize) -> Option<f64> {
        let (a, b) = (&self.candidates[one], &self.candidates[other]);
        squared_distance(self.chain_a, self.chain_b, self.same_chain, a, b)
    }

    /// Whether a candidate within one chain agrees with the odometry alone, which closes a loop with it. Between two
    /// chains, or with `--no-odometry-test`, the answer is always yes. O(1).
    pub fn agrees_with_odometry(&self, candidate: usize, gate: Gate) -> bool {
        if !self.same_chain || !self.odometry_test {
            return true;
        }
        let candidate = &self.candidates[candidate];
        match gate.per_step {
            None => squared_distance_to_odometry(self.chain_a, candidate)
                .is_some_and(|distance| distance <= gate.squared_distance),
            Some(PerStep { translation, rotation }) => {
                let place = self.chain_b.poses[candidate.k];
                let error = place.inverse().compose(&candidate.from_a).compose(&place);
                let steps = (candidate.i.abs_diff(candidate.k) + 1) as f64;
                let [x, y, z] = error.translation();
                x.hypot(y).hypot(z) <= translation * steps && error.rotation_angle() <= rotation * steps
            }
        }
    }

    /// Sets whether candidates within one chain are also tested against the odometry alone; the default is that they are.
    #[must_use]
    pub fn with_odometry_test(mut self, odometry_test: bool) -> Self {
        self.odometry_test = odometry_test;
        self
    }

    /// The result of the pre-test alone.
    pub fn pretest(&self, one: usize, other: usize, squared_distance: f64) -> Verdict {
        self.pretest.verdict(one, other, squared_distance)
    }

    /// Distance travelled between the ends of two candidates, in chain A plus in chain B, metres.
    pub fn travelled(&self, one: usize, other: usize) -> f64 {
        let ([a, b], [c, d]) = (self.position(one), self.position(other));
        (a - c).abs() + (b - d).abs()
    }

    /// Distance travelled up to the candidate's ends in chain A and in chain B, metres.
    pub fn position(&self, candidate: usize) -> [f64; 2] {
        let candidate = &self.candidates[candidate];
        [self.chain_a.travelled[candidate.i], self.chain_b.travelled[candidate.k]]
    }

    /// The free function of this name, for the candidates of this group.
    pub(crate) fn elsewhere(&self, candidate: usize, turn: usize) -> usize {
        elsewhere(self.len(), candidate, turn)
    }

    /// Whether two different candidates agree. To first order, a squared distance does not depend on the order of the two.
    /// Both tests put the earlier candidate first. O(1).
    pub fn consistent(&self, one: usize, other: usize, gate: Gate, counts: &mut PairCounts) -> bool {
        let (one, other) = (one.min(other), one.max(other));
        counts.pairs += 1;
        let limit = gate.squared_distance;
        let consistent = match gate.per_step {
            None => match self.pretest.verdict(one, other, limit) {
                Verdict::Rotation => {
                    counts.skipped_by_rotation += 1;
                    false
                }
                Verdict::Translation => {
                    counts.skipped_by_translation += 1;
                    false
                }
                Verdict::Open => {
                    let distance = self.squared_distance(one, other);
                    counts.indefinite += usize::from(distance.is_none());
                    distance.is_some_and(|distance| distance <= limit)
                }
            },
            Some(PerStep { translation, rotation }) => {
                let steps = self.pretest.steps(one, other) as f64;
                let sine = 0.5 * self.pretest.squared_turn(one, other).max(0.0).sqrt();
                let angle = 2.0 * sine.min(1.0).asin();
                angle <= rotation * steps
                    && self.pretest.squared_shift(one, other) <= (translation * steps).powi(2)
            }
        };
        counts.consistent += usize::from(consistent);
        consistent
    }

    /// The candidates that the odometry alone does not reject, and their consistency graph.
    pub fn tested_graph(&self, gate: Gate) -> (Vec<usize>, BitGraph, PairCounts) {
        let tested: Vec<usize> =
            (0..self.len()).filter(|&candidate| self.agrees_with_odometry(candidate, gate)).collect();
        let (graph, counts) = self.graph_of(&tested, gate);
        (tested, graph, counts)
    }

    /// The consistency graph: N (N - 1) / 2 pairs in tiles, with strips of 64 rows in parallel. The result does not depend
    /// on the number of threads. Memory: N^2 / 8 bytes.
    pub fn graph(&self, gate: Gate) -> (BitGraph, PairCounts) {
        let all: Vec<usize> = (0..self.candidates.len()).collect();
        self.graph_of(&all, gate)
    }

    /// The consistency graph of some of the candidates, numbered in the given order.
    pub fn graph_of(&self, chosen: &[usize], gate: Gate) -> (BitGraph, PairCounts) {
        if chosen.is_sorted() {
            return self.graph_of_ascending(chosen, gate);
        }
        // A pair puts the earlier candidate first, in whatever order the candidates are numbered.
        let mut ascending = chosen.to_vec();
        ascending.sort_unstable();
        let (graph, counts) = self.graph_of_ascending(&ascending, gate);
        let places: Vec<usize> =
            chosen.iter().map(|candidate| ascending.partition_point(|other| other < candidate)).collect();
        (graph.induced(&places), counts)
    }

    fn graph_of_ascending(&self, chosen: &[usize], gate: Gate) -> (BitGraph, PairCounts) {
        let count = chosen.len();
        let mut graph = BitGraph::new(count);
        let stride = graph.stride().max(1);
        let blocks = if gate.per_step.is_none() { self.blocks(chosen) } else { Vec::new() };
        let blocks = &blocks;
        let strips: Vec<(usize, &mut [u64])> = graph.strips().enumerate().collect();
        let counts: Vec<PairCounts> = strips
            .into_par_iter()
            .map(|(strip, words)| {
                Arch::new().dispatch(Strip {
                    pairs: self,
                    chosen,
                    blocks,
                    words,
                    stride,
                    first: 64 * strip,
                    gate,
                })
            })
            .collect();
        graph.mirror();
        let mut total = PairCounts::default();
        for counts in counts {
            total += counts;
        }
        (graph, total)
    }
}

/// 64 rows of the upper triangle, for one set of vector instructions. This is not a closure, because calls of a closure are
/// not inlined, and the functions that it calls would be compiled for the oldest supported machine.
struct Strip<'a, 'b, G, const DOF: usize> {
    pairs: &'a Pairs<'b, G, DOF>,
    chosen: &'a [usize],
    blocks: &'a [Block<DOF>],
    words: &'a mut [u64],
    stride: usize,
    first: usize,
    gate: Gate,
}

impl<G: Spatial<DOF>, const DOF: usize> WithSimd for Strip<'_, '_, G, DOF> {
    type Output = PairCounts;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> PairCounts {
        let mut counts = PairCounts::default();
        if self.gate.per_step.is_some() {
            self.one_by_one(&mut counts);
            return counts;
        }
        let Self { pairs, chosen, blocks, words, stride, first, gate } = self;
        for start in (first / WIDTH..blocks.len()).step_by(TILE) {
            let end = (start + TILE).min(blocks.len());
            for (row, words) in words.chunks_mut(stride).enumerate() {
                let row = first + row;
                if row + 1 >= WIDTH * end {
                    continue;
                }
                let one = pairs.row(chosen[row]);
                for (block, columns) in blocks[start..end].iter().zip(start..) {
                    for lane in (0..WIDTH).step_by(S::F64_LANES) {
                        let column = WIDTH * columns + lane;
                        let asked = asked(row, column, S::F64_LANES, chosen.len());
                        if asked != 0 {
                            let consistent = pairs.block(simd, &one, block, lane, asked, gate, &mut counts);
                            words[column / 64] |= consistent << (column % 64);
                        }
                    }
                }
            }
        }
        counts
    }
}

/// The lanes of a register that hold columns above the diagonal of this row.
#[inline(always)]
fn asked(row: usize, column: usize, lanes: usize, count: usize) -> u64 {
    let all = |lanes: usize| (1_u64 << lanes) - 1;
    let below = (row + 1).saturating_sub(column).min(lanes);
    let within = count.saturating_sub(column).min(lanes);
    all(within) & !all(below)
}

impl<G: Spatial<DOF>, const DOF: usize> Strip<'_, '_, G, DOF> {
    fn one_by_one(self, counts: &mut PairCounts) {
        for (row, words) in self.words.chunks_mut(self.stride).enumerate() {
            let row = self.first + row;
            for column in row + 1..self.chosen.len() {
                if self.pairs.consistent(self.chosen[row], self.chosen[column], self.gate, counts) {
                    words[column / 64] |= 1 << (column % 64);
                }
            }
        }
    }
}

impl<G: Spatial<DOF>, const DOF: usize> Pairs<'_, G, DOF> {
    fn blocks(&self, chosen: &[usize]) -> Vec<Block<DOF>> {
        let mut blocks = Vec::new();
        blocks.resize_with(chosen.len().div_ceil(WIDTH), Block::default);
        for (place, &candidate) in chosen.iter().enumerate() {
            blocks[place / WIDTH].set(
                place % WIDTH,
                (&self.pretest.turns[candidate], &self.pretest.places[candidate]),
                &self.candidates[candidate],
                (self.chain_a, self.chain_b),
            );
        }
        blocks
    }

    fn row(&self, candidate: usize) -> Row<'_, DOF> {
        Row::new(
            (&self.pretest.turns[candidate], &self.pretest.places[candidate]),
            &self.candidates[candidate],
            (self.chain_a, self.chain_b),
            self.same_chain,
        )
    }

    /// The lanes of a register that are consistent with a row, among the requested ones.
    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "what a pair is made of")]
    fn block<S: Simd>(
        &self,
        simd: S,
        row: &Row<'_, DOF>,
        block: &Block<DOF>,
        lane: usize,
        asked: u64,
        gate: Gate,
        counts: &mut PairCounts,
    ) -> u64 {
        let limit = gate.squared_distance;
        let verdicts = row.test::<G, S>(simd, block, lane, asked, (limit, self.pretest.doubled));
        counts.pairs += asked.count_ones() as usize;
        counts.skipped_by_rotation += verdicts.rotation.count_ones() as usize;
        counts.skipped_by_translation += verdicts.translation.count_ones() as usize;
        let mut open = asked & !verdicts.rotation & !verdicts.translation;
        let mut consistent = 0;
        while open != 0 {
            let other = open.trailing_zeros() as usize;
            open &= open - 1;
            let distance = verdicts.distances.0[other];
            counts.indefinite += usize::from(!distance.is_finite());
            consistent |= u64::from(distance <= limit) << other;
        }
        counts.consistent += consistent.count_ones() as usize;
        consistent
    }
}

/// The consistency graph of a group of candidates.
#[derive(Clone, Debug)]
pub struct Consistency {
    /// One vertex for each candidate, and an edge between two that are consistent.
    pub graph: BitGraph,
    /// The numbers of pairs by result.
    pub counts: PairCounts,
}

/// Tests all pairs of a group.
pub fn consistency_graph<G: Spatial<DOF>, const DOF: usize>(
    chains: &Chains<G, DOF>,
    group: &Group<G, DOF>,
    gate: Gate,
) -> Consistency {
    let (graph, counts) = Pairs::new(chains, group).graph(gate);
    Consistency { graph, counts }
}

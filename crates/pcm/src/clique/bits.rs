//! Sets of vertices and adjacency matrices as rows of bits.

/// A set of small numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct BitSet {
    words: Vec<u64>,
}

impl BitSet {
    pub(crate) fn new(capacity: usize) -> Self {
        Self { words: vec![0; capacity.div_ceil(64)] }
    }

    /// All numbers below `count`.
    pub(crate) fn full(count: usize) -> Self {
        let mut words = vec![u64::MAX; count.div_ceil(64)];
        if let Some(last) = words.last_mut()
            && !count.is_multiple_of(64)
        {
            *last = (1 << (count % 64)) - 1;
        }
        Self { words }
    }

    pub(crate) fn words(&self) -> &[u64] {
        &self.words
    }

    pub(crate) fn insert(&mut self, member: usize) {
        self.words[member / 64] |= 1 << (member % 64);
    }

    pub(crate) fn remove(&mut self, member: usize) {
        self.words[member / 64] &= !(1 << (member % 64));
    }

    pub(crate) fn contains(&self, member: usize) -> bool {
        contains(&self.words, member)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    pub(crate) fn clear(&mut self) {
        self.words.fill(0);
    }

    pub(crate) fn count(&self) -> usize {
        count(&self.words)
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.words.copy_from_slice(&other.words);
    }

    /// Sets this to the intersection of two sets.
    pub(crate) fn assign_intersection(&mut self, one: &Self, other: &[u64]) {
        for ((word, one), other) in self.words.iter_mut().zip(&one.words).zip(other) {
            *word = one & other;
        }
    }

    /// Sets this to the members of `one` that are not in `other`.
    pub(crate) fn assign_difference(&mut self, one: &Self, other: &[u64]) {
        for ((word, one), other) in self.words.iter_mut().zip(&one.words).zip(other) {
            *word = one & !other;
        }
    }

    pub(crate) fn intersect(&mut self, other: &[u64]) {
        for (word, other) in self.words.iter_mut().zip(other) {
            *word &= other;
        }
    }

    pub(crate) fn subtract(&mut self, other: &[u64]) {
        for (word, other) in self.words.iter_mut().zip(other) {
            *word &= !other;
        }
    }

    /// The smallest member at or after a given word.
    pub(crate) fn first_from(&self, first: usize) -> Option<usize> {
        let place = first + self.words[first..].iter().position(|&word| word != 0)?;
        Some(place * 64 + self.words[place].trailing_zeros() as usize)
    }

    /// Removes the members of `other`, from a given word on.
    pub(crate) fn subtract_from(&mut self, first: usize, other: &[u64]) {
        for (word, other) in self.words[first..].iter_mut().zip(&other[first..]) {
            *word &= !other;
        }
    }

    pub(crate) fn members(&self) -> impl Iterator<Item = usize> + '_ {
        members(self.words.iter().copied())
    }

    /// Members that are not in `row`. If `row` is a row of adjacency, these are the non-neighbours.
    pub(crate) fn members_outside<'a>(&'a self, row: &'a [u64]) -> impl Iterator<Item = usize> + 'a {
        members(self.words.iter().zip(row).map(|(word, row)| word & !row))
    }

    /// Members that are also in `row`.
    pub(crate) fn members_within<'a>(&'a self, row: &'a [u64]) -> impl Iterator<Item = usize> + 'a {
        members(self.words.iter().zip(row).map(|(word, row)| word & row))
    }

    /// How many members are also in `row`.
    pub(crate) fn count_within(&self, row: &[u64]) -> usize {
        self.words.iter().zip(row).map(|(word, row)| (word & row).count_ones() as usize).sum()
    }

    /// Whether every member of this set that is in `row` is also in `other`. Tests the words from `start` on first: if a
    /// counterexample is there, the answer comes quickly.
    pub(crate) fn is_within(&self, row: &[u64], other: &[u64], start: usize) -> bool {
        let within = |places: std::ops::Range<usize>| {
            let words = self.words[places.clone()].iter().zip(&row[places.clone()]).zip(&other[places]);
            words.into_iter().all(|((word, row), other)| word & row & !other == 0)
        };
        within(start..self.words.len()) && within(0..start)
    }
}

fn members(words: impl Iterator<Item = u64>) -> impl Iterator<Item = usize> {
    words.enumerate().flat_map(|(place, word)| Bits { word, base: place * 64 })
}

/// The indices of the bits set in one word.
struct Bits {
    word: u64,
    base: usize,
}

impl Iterator for Bits {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        if self.word == 0 {
            return None;
        }
        let bit = self.word.trailing_zeros() as usize;
        self.word &= self.word - 1;
        Some(self.base + bit)
    }
}

pub(super) fn contains(words: &[u64], member: usize) -> bool {
    words[member / 64] >> (member % 64) & 1 == 1
}

fn count(words: &[u64]) -> usize {
    words.iter().map(|word| word.count_ones() as usize).sum()
}

/// An undirected graph without loops, as a bit matrix: N^2 / 8 bytes in one block.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BitGraph {
    vertices: usize,
    /// The number of words in a row.
    stride: usize,
    words: Vec<u64>,
}

impl BitGraph {
    /// A graph without edges.
    pub fn new(vertices: usize) -> Self {
        let stride = vertices.div_ceil(64);
        Self { vertices, stride, words: vec![0; vertices * stride] }
    }

    /// The number of vertices.
    pub fn len(&self) -> usize {
        self.vertices
    }

    /// Whether the graph has no vertices.
    pub fn is_empty(&self) -> bool {
        self.vertices == 0
    }

    /// Connects two different vertices.
    pub fn connect(&mut self, one: usize, other: usize) {
        debug_assert_ne!(one, other, "a consistency graph has no loops");
        self.words[one * self.stride + other / 64] |= 1 << (other % 64);
        self.words[other * self.stride + one / 64] |= 1 << (one % 64);
    }

    /// Adds a vertex without neighbours and returns its number. Amortised O(N / 64), because rows double in width.
    pub fn add_vertex(&mut self) -> usize {
        let vertex = self.vertices;
        if vertex == self.stride * 64 {
            let stride = (2 * self.stride).max(1);
            let mut words = vec![0; self.vertices * stride];
            for (old, new) in self.words.chunks(self.stride.max(1)).zip(words.chunks_mut(stride)) {
                new[..self.stride].copy_from_slice(old);
            }
            (self.stride, self.words) = (stride, words);
        }
        self.vertices += 1;
        self.words.resize(self.vertices * self.stride, 0);
        vertex
    }

    /// Whether two vertices are connected.
    pub fn connected(&self, one: usize, other: usize) -> bool {
        contains(self.neighbours(one), other)
    }

    /// The number of neighbours of a vertex.
    pub fn degree(&self, vertex: usize) -> usize {
        count(self.neighbours(vertex))
    }

    /// The number of edges.
    pub fn edges(&self) -> usize {
        count(&self.words) / 2
    }

    /// The neighbours of a vertex above it, ascending.
    pub fn neighbours_above(&self, vertex: usize) -> impl Iterator<Item = usize> + '_ {
        members(self.neighbours(vertex).iter().copied()).filter(move |&neighbour| neighbour > vertex)
    }

    /// Whether these vertices are pairwise connected.
    pub fn is_clique(&self, vertices: &[usize]) -> bool {
        vertices
            .iter()
            .enumerate()
            .all(|(place, &one)| vertices[place + 1..].iter().all(|&other| self.connected(one, other)))
    }

    /// The subgraph of the given vertices, numbered in the given order. O(n^2).
    #[must_use]
    pub fn induced(&self, vertices: &[usize]) -> Self {
        let mut graph = Self::new(vertices.len());
        for (row, &one) in graph.words.chunks_mut(graph.stride.max(1)).zip(vertices) {
            let neighbours = self.neighbours(one);
            for (word, group) in row.iter_mut().zip(vertices.chunks(64)) {
                for (bit, &other) in group.iter().enumerate() {
                    *word |= u64::from(contains(neighbours, other)) << bit;
                }
            }
        }
        graph
    }

    pub(crate) fn neighbours(&self, vertex: usize) -> &[u64] {
        &self.words[vertex * self.stride..(vertex + 1) * self.stride]
    }

    /// The rows of the matrix, 64 vertices at a time, to fill the upper triangle in parallel. [`Self::mirror`] then makes
    /// the matrix symmetric.
    pub(crate) fn strips(&mut self) -> std::slice::ChunksMut<'_, u64> {
        self.words.chunks_mut((64 * self.stride).max(1))
    }

    /// The number of words in a row.
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// Copies the upper triangle to the lower one in blocks of 64 x 64 bits. O(N^2 / 64) words.
    pub(crate) fn mirror(&mut self) {
        let mut block = [0_u64; 64];
        for first in 0..self.vertices.div_ceil(64) {
            for second in first..self.vertices.div_ceil(64) {
                let height = 64.min(self.vertices - 64 * first);
                for (row, word) in block.iter_mut().enumerate() {
                    *word =
                        if row < height { self.words[(64 * first + row) * self.stride + second] } else { 0 };
                }
                if block.iter().all(|&word| word == 0) {
                    continue;
                }
                transpose(&mut block);
                let width = 64.min(self.vertices - 64 * second);
                for (row, word) in block.iter().enumerate().take(width) {
                    self.words[(64 * second + row) * self.stride + first] |= word;
                }
            }
        }
    }
}

/// Transposes a block of 64 x 64 bits: six rounds of exchanging halves (Warren, Hacker's Delight, section 7-3).
fn transpose(block: &mut [u64; 64]) {
    let mut width = 32;
    let mut mask = 0x0000_0000_FFFF_FFFF_u64;
    while width != 0 {
        let mut row = 0;
        while row < 64 {
            let exchanged = ((block[row] >> width) ^ block[row | width]) & mask;
            block[row] ^= exchanged << width;
            block[row | width] ^= exchanged;
            row = ((row | width) + 1) & !width;
        }
        width /= 2;
        mask ^= mask << width;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_set_is_within_another_whatever_word_is_looked_at_first(
            sets in proptest::collection::vec((0_usize..200, 0_usize..5), 0..40),
            start in 0_usize..4,
        ) {
            // Only a member of both the set and the row that is not in the other set is a counterexample.
            let mut parts = [BitSet::new(200), BitSet::new(200), BitSet::new(200)];
            for &(member, kind) in &sets {
                let holders: &[usize] = [&[0, 1, 2][..], &[0, 2], &[1, 2], &[0], &[0, 1]][kind];
                for &part in holders {
                    parts[part].insert(member);
                }
            }
            let [set, row, other] = &parts;
            let expected = set.members().all(|member| !row.contains(member) || other.contains(member));
            prop_assert_eq!(set.is_within(row.words(), other.words(), start), expected);
        }

        #[test]
        fn the_mirrored_matrix_is_the_symmetric_one(
            size in 1_usize..200,
            edges in proptest::collection::vec((0_usize..200, 0_usize..200), 0..300),
        ) {
            let (mut upper, mut both) = (BitGraph::new(size), BitGraph::new(size));
            for (one, other) in edges {
                let (one, other) = (one.min(other), one.max(other));
                if one < other && other < size {
                    upper.words[one * upper.stride + other / 64] |= 1 << (other % 64);
                    both.connect(one, other);
                }
            }
            upper.mirror();
            prop_assert_eq!(upper, both);
        }

        #[test]
        fn a_graph_that_grew_is_the_graph_made_at_once(
            size in 0_usize..150,
            edges in proptest::collection::vec((0_usize..150, 0_usize..150), 0..100),
        ) {
            let (mut grown, mut whole) = (BitGraph::default(), BitGraph::new(size));
            for vertex in 0..size {
                prop_assert_eq!(grown.add_vertex(), vertex);
                for &(one, other) in edges.iter().filter(|&&(one, other)| one.max(other) == vertex && one != other) {
                    grown.connect(one, other);
                    whole.connect(one, other);
                }
            }
            for one in 0..size {
                for other in 0..size {
                    prop_assert_eq!(grown.connected(one, other), whole.connected(one, other));
                }
            }
        }
    }
}

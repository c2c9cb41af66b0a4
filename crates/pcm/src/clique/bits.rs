//! Sets of vertices and adjacency as rows of bits.

/// A set of small numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct BitSet {
    words: Vec<u64>,
}

impl BitSet {
    pub(crate) fn new(capacity: usize) -> Self {
        Self { words: vec![0; capacity.div_ceil(64)] }
    }

    pub(crate) fn insert(&mut self, member: usize) {
        self.words[member / 64] |= 1 << (member % 64);
    }

    pub(crate) fn remove(&mut self, member: usize) {
        self.words[member / 64] &= !(1 << (member % 64));
    }

    pub(crate) fn contains(&self, member: usize) -> bool {
        self.words[member / 64] >> (member % 64) & 1 == 1
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    pub(crate) fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The smallest member.
    pub(crate) fn first(&self) -> Option<usize> {
        let word = self.words.iter().position(|&word| word != 0)?;
        Some(word * 64 + self.words[word].trailing_zeros() as usize)
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.words.copy_from_slice(&other.words);
    }

    pub(crate) fn intersect(&mut self, other: &Self) {
        for (word, other) in self.words.iter_mut().zip(&other.words) {
            *word &= other;
        }
    }

    pub(crate) fn subtract(&mut self, other: &Self) {
        for (word, other) in self.words.iter_mut().zip(&other.words) {
            *word &= !other;
        }
    }

    pub(crate) fn members(&self) -> impl Iterator<Item = usize> + '_ {
        self.words.iter().enumerate().flat_map(|(place, &word)| {
            std::iter::successors((word != 0).then_some(word), |&rest| {
                let rest = rest & (rest - 1);
                (rest != 0).then_some(rest)
            })
            .map(move |rest| place * 64 + rest.trailing_zeros() as usize)
        })
    }
}

/// An undirected graph without loops as a bit matrix: N^2 / 8 bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BitGraph {
    rows: Vec<BitSet>,
}

impl BitGraph {
    /// A graph without edges.
    pub fn new(vertices: usize) -> Self {
        Self { rows: vec![BitSet::new(vertices); vertices] }
    }

    /// The number of vertices.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no vertex.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Connects two different vertices.
    pub fn connect(&mut self, one: usize, other: usize) {
        debug_assert_ne!(one, other, "a consistency graph has no loops");
        self.rows[one].insert(other);
        self.rows[other].insert(one);
    }

    /// Whether two vertices are connected.
    pub fn connected(&self, one: usize, other: usize) -> bool {
        self.rows[one].contains(other)
    }

    /// The number of neighbours of a vertex.
    pub fn degree(&self, vertex: usize) -> usize {
        self.rows[vertex].count()
    }

    /// The number of edges.
    pub fn edges(&self) -> usize {
        self.rows.iter().map(BitSet::count).sum::<usize>() / 2
    }

    pub(crate) fn neighbours(&self, vertex: usize) -> &BitSet {
        &self.rows[vertex]
    }
}

//! Everything about a factorisation that depends on the pattern alone.
//!
//! [`elimination`]: the elimination tree and the structure of columns (Liu, SIAM J. Matrix Anal. Appl. 11, 1990);
//! [`supernodes`]: columns eliminated together as one front; [`subtrees`]: what threads take. Depends on
//! [`ordering`](super::ordering).

mod elimination;
mod subtrees;
mod supernodes;

use std::collections::BTreeSet;
use std::ops::Range;

use super::ordering::minimum_degree::approximate_minimum_degree;
use super::ordering::nested_dissection::nested_dissection;
use crate::Adjacency;
use elimination::{elimination_tree, postorder};
use supernodes::{amalgamate, maximal};

/// Operations by minimum degree from which nested dissection is tried too: its analysis takes several times as long, and a
/// cheap factorisation would not pay that back.
const WORTH_DISSECTION: f64 = 2e8;

/// No parent front.
pub(crate) const NO_PARENT: usize = usize::MAX;

/// One dense front of the multifrontal method. Sizes and offsets count blocks.
#[derive(Debug)]
pub(crate) struct Front {
    /// First column, in elimination order.
    pub(crate) first: usize,
    /// Columns eliminated here.
    pub(crate) columns: usize,
    /// Range in [`Symbolic::rows`] of the rows below.
    pub(crate) rows: Range<usize>,
    /// Front that takes the update, or [`NO_PARENT`].
    pub(crate) parent: usize,
    /// Offset of the panel (columns x height) in the factor.
    pub(crate) panel: usize,
    /// Offset of the update matrix on its stack.
    pub(crate) update: usize,
    /// Which of the two stacks holds the update: the parity of the depth.
    pub(crate) stack: usize,
    /// Range in [`Symbolic::children`].
    pub(crate) children: Range<usize>,
    /// Range in [`Symbolic::entries`] of the matrix's off-diagonal blocks.
    pub(crate) entries: Range<usize>,
}

/// Fronts that one thread factorises, and what it writes. Blocks.
#[derive(Debug)]
pub(crate) struct Stretch {
    /// Children before parents.
    pub(crate) fronts: Vec<usize>,
    /// Range in the factor; of the last stretch, that of all its fronts and of others in between.
    pub(crate) panels: Range<usize>,
    /// Range on each stack.
    pub(crate) stacks: [Range<usize>; 2],
}

impl Front {
    /// Rows below the eliminated columns.
    pub(crate) fn below(&self) -> usize {
        self.rows.len()
    }

    /// Where its panel ends in the factor.
    fn panel_end(&self) -> usize {
        self.panel + self.columns * self.height()
    }

    /// Rows of the front.
    pub(crate) fn height(&self) -> usize {
        self.columns + self.rows.len()
    }
}

/// Where an off-diagonal block of the matrix goes in a front's panel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Index of the block among the pairs.
    pub(crate) pair: usize,
    /// Block column in the panel.
    pub(crate) column: usize,
    /// Block row in the panel.
    pub(crate) row: usize,
    /// The stored block is that of the upper triangle in elimination order.
    pub(crate) transposed: bool,
}

/// Order of elimination, fronts, and the map from matrix to fronts, for one pattern of blocks.
#[derive(Debug)]
pub struct Symbolic {
    pub(crate) order: Vec<usize>,
    /// Inverse of `order`.
    pub(crate) position: Vec<usize>,
    pub(crate) fronts: Vec<Front>,
    pub(crate) rows: Vec<usize>,
    /// For each entry of `rows`: its block row in the parent's front.
    pub(crate) relative: Vec<usize>,
    pub(crate) children: Vec<usize>,
    pub(crate) entries: Vec<Entry>,
    /// Front of each position.
    pub(crate) front_of: Vec<usize>,
    pub(crate) panel_blocks: usize,
    pub(crate) stack_blocks: [usize; 2],
    /// What threads may take side by side, and as the last one the rest, which comes after all others.
    pub(crate) stretches: Vec<Stretch>,
    flops: f64,
}

impl Symbolic {
    /// Analyses a symmetric pattern of `variables` diagonal blocks and the off-diagonal blocks `pairs`.
    ///
    /// Each pair is given once, smaller variable first; the numeric phase takes its blocks in the same order. `block`
    /// is the block size that fronts are tuned for, not a limit. The order is by approximate minimum degree or, where that
    /// leaves much to do, by nested dissection, whichever takes fewer operations. Takes time proportional to the factor's blocks, plus
    /// the ordering's.
    pub fn new(variables: usize, pairs: &[(usize, usize)], block: usize) -> Self {
        let order = approximate_minimum_degree(variables, pairs);
        let symbolic = Self::with_order(pairs, &order, block);
        if symbolic.flops < WORTH_DISSECTION {
            return symbolic;
        }
        let dissected = Self::with_order(pairs, &nested_dissection(variables, pairs), block);
        if dissected.flops < symbolic.flops { dissected } else { symbolic }
    }

    /// Analyses with a given order of elimination, `order[position] = variable`.
    pub(crate) fn with_order(pairs: &[(usize, usize)], order: &[usize], block: usize) -> Self {
        let variables = order.len();
        let mut position = inverse(order);
        let place = |position: &[usize], &(a, b): &(usize, usize)| {
            let (a, b) = (position[a], position[b]);
            (a.min(b), a.max(b))
        };
        let lower =
            Adjacency::new(variables, pairs.iter().map(|pair| place(&position, pair)).map(|(a, b)| (b, a)));
        let parent = elimination_tree(variables, &lower);
        // Fronts need their subtrees to be contiguous; a postorder changes nothing else.
        let post = postorder(&parent);
        let order: Vec<usize> = post.iter().map(|&old| order[old]).collect();
        position = inverse(&order);
        let renamed = inverse(&post);
        let parent: Vec<usize> = post
            .iter()
            .map(|&old| parent.get(parent[old]).map_or(usize::MAX, |_| renamed[parent[old]]))
            .collect();
        let upper = Adjacency::new(variables, pairs.iter().map(|pair| place(&position, pair)));
        let supernodes = amalgamate(maximal(&parent, &upper), block);

        let mut symbolic = Self {
            order,
            position: Vec::new(),
            fronts: Vec::with_capacity(supernodes.len()),
            rows: Vec::new(),
            relative: Vec::new(),
            children: Vec::new(),
            entries: Vec::new(),
            front_of: vec![0; variables],
            panel_blocks: 0,
            stack_blocks: [0, 0],
            stretches: Vec::new(),
            flops: 0.0,
        };
        for supernode in supernodes {
            let start = symbolic.rows.len();
            symbolic.rows.extend_from_slice(&supernode.rows);
            let index = symbolic.fronts.len();
            symbolic.front_of[supernode.first..supernode.first + supernode.columns].fill(index);
            let front = Front {
                first: supernode.first,
                columns: supernode.columns,
                rows: start..symbolic.rows.len(),
                parent: NO_PARENT,
                panel: symbolic.panel_blocks,
                update: 0,
                stack: 0,
                children: 0..0,
                entries: 0..0,
            };
            symbolic.panel_blocks += front.columns * front.height();
            symbolic.fronts.push(front);
        }
        symbolic.link_parents();
        let work: Vec<f64> = symbolic.fronts.iter().map(|front| front_flops(front, block)).collect();
        symbolic.flops = work.iter().sum();
        symbolic.place_updates(&subtrees::independent(&symbolic.fronts, &work));
        symbolic.place_entries(pairs, &position);
        symbolic.position = position;
        symbolic
    }

    /// Number of block variables.
    pub fn variables(&self) -> usize {
        self.order.len()
    }

    /// Blocks stored in the factor, explicit zeros of merged fronts included.
    pub fn factor_blocks(&self) -> usize {
        self.panel_blocks
    }

    /// Floating-point operations of one numeric factorisation at the block size the fronts were tuned for.
    pub fn flops(&self) -> f64 {
        self.flops
    }

    /// The fronts on the ways from these variables to the roots, children before parents.
    pub(crate) fn path_to_root(&self, variables: impl Iterator<Item = usize>) -> Vec<usize> {
        let mut path = BTreeSet::new();
        for variable in variables {
            let mut front = self.front_of[self.position[variable]];
            while front != NO_PARENT && path.insert(front) {
                front = self.fronts[front].parent;
            }
        }
        path.into_iter().collect()
    }

    /// Sets parents, lists of children, and the rows' places in the parent's front.
    fn link_parents(&mut self) {
        self.relative = vec![0; self.rows.len()];
        let mut arcs = Vec::new();
        for index in 0..self.fronts.len() {
            let rows = self.fronts[index].rows.clone();
            let Some(&first_row) = self.rows.get(rows.start).filter(|_| !rows.is_empty()) else { continue };
            let parent = self.front_of[first_row];
            self.fronts[index].parent = parent;
            arcs.push((parent, index));
            let target = &self.fronts[parent];
            let mut below = target.rows.clone();
            for place in rows {
                let row = self.rows[place];
                self.relative[place] = if row < target.first + target.columns {
                    row - target.first
                } else {
                    // Both lists ascend, so one walk finds every row.
                    while below.start < below.end && self.rows[below.start] < row {
                        below.start += 1;
                    }
                    target.columns + below.start - target.rows.start
                };
            }
        }
        let children = Adjacency::new(self.fronts.len(), arcs.iter().copied());
        for index in 0..self.fronts.len() {
            let start = self.children.len();
            self.children.extend_from_slice(children.of(index));
            self.fronts[index].children = start..self.children.len();
        }
    }

    /// Gives every update matrix its place on one of two stacks.
    ///
    /// When a front is assembled, the updates of its children are on top of the stack of the children's depth; its own
    /// update goes on top of the other one. With two stacks neither moves, and the two can be borrowed apart. Fronts that threads
    /// take side by side have stretches of the stacks of their own, below those of the rest.
    fn place_updates(&mut self, independent: &[Range<usize>]) {
        for index in (0..self.fronts.len()).rev() {
            let parent = self.fronts[index].parent;
            self.fronts[index].stack = self.fronts.get(parent).map_or(0, |parent| 1 - parent.stack);
        }
        // 0 is the rest.
        let mut regions = vec![0; self.fronts.len()];
        let mut base = [0, 0];
        for (index, fronts) in independent.iter().enumerate() {
            regions[fronts.clone()].fill(index + 1);
            let end = self.place_region(fronts.clone().collect(), &regions, base);
            base = end;
        }
        let rest = (0..self.fronts.len()).filter(|&front| regions[front] == 0).collect();
        self.stack_blocks = self.place_region(rest, &regions, base);
    }

    /// Adds a stretch of these fronts, all of one region, whose updates lie on the stacks from `base` on. Returns where they end at
    /// most.
    fn place_region(&mut self, fronts: Vec<usize>, regions: &[usize], base: [usize; 2]) -> [usize; 2] {
        let (mut top, mut end) = (base, base);
        for &index in &fronts {
            let front = &self.fronts[index];
            let (own, others) = (front.stack, 1 - front.stack);
            let size = front.below() * front.below();
            let released: usize = self.children[front.children.clone()]
                .iter()
                .filter(|&&child| regions[child] == regions[index])
                .map(|&child| self.fronts[child].below())
                .map(|below| below * below)
                .sum();
            self.fronts[index].update = top[own];
            top[own] += size;
            end[own] = end[own].max(top[own]);
            top[others] -= released;
        }
        let start = fronts.first().map_or(0, |&front| self.fronts[front].panel);
        let panel_end = fronts.last().map_or(0, |&front| self.fronts[front].panel_end());
        self.stretches.push(Stretch {
            fronts,
            panels: start..panel_end,
            stacks: [base[0]..end[0], base[1]..end[1]],
        });
        end
    }

    /// Sorts the matrix's off-diagonal blocks by front.
    fn place_entries(&mut self, pairs: &[(usize, usize)], position: &[usize]) {
        let column_of = |&(a, b): &(usize, usize)| position[a].min(position[b]);
        let by_front = Adjacency::new(
            self.fronts.len(),
            pairs.iter().enumerate().map(|(index, pair)| (self.front_of[column_of(pair)], index)),
        );
        self.entries.reserve(pairs.len());
        for index in 0..self.fronts.len() {
            let start = self.entries.len();
            for &pair in by_front.of(index) {
                let front = &self.fronts[index];
                let (a, b) = (position[pairs[pair].0], position[pairs[pair].1]);
                let row = a.max(b);
                let local_row = if row < front.first + front.columns {
                    row - front.first
                } else {
                    front.columns + self.rows[front.rows.clone()].partition_point(|&other| other < row)
                };
                let column = a.min(b) - front.first;
                self.entries.push(Entry { pair, column, row: local_row, transposed: a < b });
            }
            self.fronts[index].entries = start..self.entries.len();
        }
    }
}

/// `result[values[i]] = i`.
fn inverse(values: &[usize]) -> Vec<usize> {
    let mut result = vec![0; values.len()];
    for (index, &value) in values.iter().enumerate() {
        result[value] = index;
    }
    result
}

/// Operations of a partial dense Cholesky: `sum over columns of (rows at and below)^2`.
fn front_flops(front: &Front, block: usize) -> f64 {
    let columns = (front.columns * block) as f64;
    let below = (front.below() * block) as f64;
    columns * below * below + columns * columns * below + columns.powi(3) / 3.0
}

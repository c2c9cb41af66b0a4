//! Everything about a factorisation that depends on the pattern alone.
//!
//! [`elimination`]: the elimination tree and the structure of columns (Liu, SIAM J. Matrix Anal. Appl. 11, 1990);
//! [`supernodes`]: columns eliminated together as one [`front`]; [`links`]: parents and children of fronts; [`subtrees`]: what threads
//! take; [`stacks`]: where updates wait; [`entries`]: where blocks of the matrix go. Depends on [`ordering`](super::ordering).

mod elimination;
mod entries;
mod front;
mod links;
mod stacks;
mod subtrees;
mod supernodes;

use std::collections::BTreeSet;

use super::ordering::minimum_degree::approximate_minimum_degree;
use super::ordering::nested_dissection::nested_dissection;
use crate::Adjacency;
use elimination::{elimination_tree, postorder};
use front::{Entry, front_flops};
use supernodes::{amalgamate, maximal};

pub(crate) use front::{Front, NO_PARENT, Stretch};

/// Operations by minimum degree from which nested dissection is tried too: its analysis takes several times as long, and a
/// cheap factorisation would not pay that back.
const WORTH_DISSECTION: f64 = 2e8;

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
}

/// `result[values[i]] = i`.
fn inverse(values: &[usize]) -> Vec<usize> {
    let mut result = vec![0; values.len()];
    for (index, &value) in values.iter().enumerate() {
        result[value] = index;
    }
    result
}

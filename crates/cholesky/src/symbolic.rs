//! The part of a factorisation that depends only on the pattern of the matrix.
//!
//! [`elimination`]: the elimination tree and the structure of columns (Liu, SIAM J. Matrix Anal. Appl. 11, 1990);
//! [`supernodes`]: columns eliminated together as one [`front`]; [`links`]: parents and children of fronts; [`subtrees`]: the
//! work of threads; [`stacks`]: memory of update matrices; [`entries`]: positions of the matrix's blocks in the fronts.
//! Depends on [`ordering`](super::ordering).

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
use elimination::{ROOT, elimination_tree, postorder};
use front::{Entry, front_flops};
use supernodes::{Supernodes, amalgamate, maximal};

pub(crate) use front::{Front, NO_PARENT, Stretch};
pub(crate) use subtrees::Subtree;

/// If minimum degree needs more operations than this for each variable, nested dissection is tried too. It takes some 4 microseconds for each
/// variable, which cheaper factorisations do not pay back.
const WORTH_DISSECTION: f64 = 8e4;

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
    /// Stretches that threads may factorise in parallel; the last one is the rest, which comes after all others.
    pub(crate) stretches: Vec<Stretch>,
    pub(crate) subtrees: Vec<Subtree>,
    /// The fronts above all subtrees, children before parents.
    pub(crate) top: Vec<usize>,
    flops: f64,
}

impl Symbolic {
    /// Analyses a symmetric pattern of `variables` diagonal blocks and the off-diagonal blocks `pairs`.
    ///
    /// Each pair is given once, smaller variable first; the numeric phase takes its blocks in the same order. `block` is the
    /// block size that fronts are tuned for, not a limit. The order is that of approximate minimum degree or, if this needs
    /// many operations, of nested dissection if it needs fewer. Takes time proportional to the factor's blocks, plus the time
    /// of the ordering.
    pub fn new(variables: usize, pairs: &[(usize, usize)], block: usize) -> Self {
        let order = approximate_minimum_degree(variables, pairs);
        let symbolic = Self::with_order(pairs, &order, block);
        if symbolic.flops < WORTH_DISSECTION * variables as f64 {
            return symbolic;
        }
        let dissected = Self::with_order(pairs, &nested_dissection(variables, pairs), block);
        if dissected.flops < symbolic.flops { dissected } else { symbolic }
    }

    /// Analyses with a given order of elimination, `order[position] = variable`.
    pub(crate) fn with_order(pairs: &[(usize, usize)], order: &[usize], block: usize) -> Self {
        let (order, parent) = in_postorder(pairs, order);
        let position = inverse(&order);
        let upper = Adjacency::new(order.len(), pairs.iter().map(|&pair| placed(&position, pair)));
        let mut symbolic = Self::of_supernodes(order, &amalgamate(maximal(&parent, &upper), block));
        symbolic.link_parents();
        let work: Vec<f64> = symbolic.fronts.iter().map(|front| front_flops(front, block)).collect();
        symbolic.flops = work.iter().sum();
        let subtrees = subtrees::independent(&symbolic.fronts, &work);
        symbolic.divide(&subtrees);
        // A single thread reuses the memory of one subtree for the next. The numbers in a front are the same in both cases.
        symbolic.place_updates(if rayon::current_num_threads() < 2 { &[] } else { &subtrees });
        symbolic.place_entries(pairs, &position);
        symbolic.position = position;
        symbolic
    }

    /// Makes a front of each supernode, one panel after the other, so that the factor is one piece of memory in the order in
    /// which fronts are eliminated. Links between fronts are still missing.
    fn of_supernodes(order: Vec<usize>, supernodes: &Supernodes) -> Self {
        let mut symbolic = Self {
            position: Vec::new(),
            fronts: Vec::with_capacity(supernodes.runs.len()),
            rows: Vec::with_capacity(supernodes.rows.len()),
            relative: Vec::new(),
            children: Vec::new(),
            entries: Vec::new(),
            front_of: vec![0; order.len()],
            panel_blocks: 0,
            stack_blocks: [0, 0],
            stretches: Vec::new(),
            subtrees: Vec::new(),
            top: Vec::new(),
            flops: 0.0,
            order,
        };
        for supernode in &supernodes.runs {
            let start = symbolic.rows.len();
            symbolic.rows.extend_from_slice(&supernodes.rows[supernode.rows.clone()]);
            let index = symbolic.fronts.len();
            symbolic.front_of[supernode.first..supernode.first + supernode.columns].fill(index);
            let front = Front {
                first: supernode.first,
                columns: supernode.columns,
                rows: start..symbolic.rows.len(),
                parent: NO_PARENT,
                panel: symbolic.panel_blocks,
                update: 0,
                corner: 0,
                stack: 0,
                children: 0..0,
                entries: 0..0,
            };
            symbolic.panel_blocks += front.columns * front.height();
            symbolic.fronts.push(front);
        }
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

    /// The fronts on the paths from these variables to the roots, children before parents.
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

/// An order with the same factor in which every subtree of the elimination tree is contiguous, and the tree by position.
///
/// Fronts need this: a supernode is a run of columns, a subtree is a range of fronts, and updates can wait on a stack. A
/// postorder of the tree has the same fill, with variables renamed (Liu, 1990).
fn in_postorder(pairs: &[(usize, usize)], order: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let position = inverse(order);
    let lower = pairs.iter().map(|&pair| placed(&position, pair)).map(|(a, b)| (b, a));
    let parent = elimination_tree(order.len(), &Adjacency::new(order.len(), lower));
    let post = postorder(&parent);
    let renamed = inverse(&post);
    let new_parent = |&old: &usize| if parent[old] == ROOT { ROOT } else { renamed[parent[old]] };
    (post.iter().map(|&old| order[old]).collect(), post.iter().map(new_parent).collect())
}

/// The positions of a pair, the smaller one first.
fn placed(position: &[usize], (a, b): (usize, usize)) -> (usize, usize) {
    let (a, b) = (position[a], position[b]);
    (a.min(b), a.max(b))
}

/// `result[values[i]] = i`.
fn inverse(values: &[usize]) -> Vec<usize> {
    let mut result = vec![0; values.len()];
    for (index, &value) in values.iter().enumerate() {
        result[value] = index;
    }
    result
}

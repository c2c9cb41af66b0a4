//! The numeric elimination of one clique.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::collections::HashMap;

use nalgebra::{SMatrix, SVector};
use posecut_cholesky::SINGULAR;
use posecut_cholesky::fronts::{FrontView, Run, Scratch, eliminate, extend_add, push_rows};
use posecut_geometry::translations;
use posecut_optimize::model::Linearised;
use pulp::{Simd, WithSimd};

use crate::tree::{Clique, Tree};
use posecut_cholesky::instructions::for_small_blocks;

/// Number of rounds that hold only one more direction each.
const SINGLE_ROUNDS: usize = 8;

/// Where the elimination of a clique failed.
struct Failure {
    /// A column whose direction is undetermined.
    column: usize,
    /// Rows of the panel.
    height: usize,
    /// Whether elimination stopped at this column.
    broke_down: bool,
}

/// The linearised edges at a node, as seen from it.
pub(crate) trait Incidence<const D: usize> {
    /// Calls back with the edge's other end, the model, and whether the node is the edge's `from`.
    fn for_each(&self, node: usize, each: impl FnMut(usize, &Linearised<D>, bool));
}

/// Some linearised edges, listed at their ends.
pub(crate) struct Restricted<'a, const D: usize>(HashMap<usize, Vec<(usize, &'a Linearised<D>, bool)>>);

impl<'a, const D: usize> Restricted<'a, D> {
    /// Lists edges, each with its `from`, its `to` and its model.
    pub(crate) fn new(edges: impl Iterator<Item = (usize, usize, &'a Linearised<D>)>) -> Self {
        let mut at: HashMap<usize, Vec<_>> = HashMap::new();
        for (from, to, model) in edges {
            at.entry(from).or_default().push((to, model, true));
            at.entry(to).or_default().push((from, model, false));
        }
        Self(at)
    }
}

impl<const D: usize> Incidence<D> for Restricted<'_, D> {
    #[inline(always)]
    fn for_each(&self, node: usize, mut each: impl FnMut(usize, &Linearised<D>, bool)) {
        for &(other, model, is_from) in self.0.get(&node).into_iter().flatten() {
            each(other, model, is_from);
        }
    }
}

/// The working memory of elimination.
pub(crate) struct Elimination<const D: usize> {
    /// Position of each node in the current clique.
    place: Vec<usize>,
    /// Stamp of the clique for which a node's `place` was set.
    clique: Vec<usize>,
    stamp: usize,
    scratch: Scratch,
    diagonal: Vec<f64>,
    held: Vec<bool>,
    runs: Vec<Run>,
}

impl<const D: usize> std::fmt::Debug for Elimination<D> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Elimination").finish_non_exhaustive()
    }
}

impl<const D: usize> Elimination<D> {
    pub(crate) fn new() -> Self {
        Self {
            place: Vec::new(),
            clique: Vec::new(),
            stamp: 0,
            scratch: Scratch::default(),
            diagonal: Vec::new(),
            held: Vec::new(),
            runs: Vec::new(),
        }
    }

    pub(crate) fn add_node(&mut self) {
        self.place.push(0);
        self.clique.push(0);
    }

    /// Eliminates cliques, children before parents.
    pub(crate) fn eliminate(
        &mut self,
        tree: &mut Tree,
        cliques: &[usize],
        edges: &impl Incidence<D>,
        deltas: &[SVector<f64, D>],
    ) {
        // Vector instructions of the machine, chosen here once for all loops that are inlined below.
        for_small_blocks(Eliminate { elimination: self, tree, cliques, edges, deltas });
    }

    /// Assembles a clique's front from edges and children, and eliminates its frontal variables.
    ///
    /// The front is the lower triangle of `[H, -g; -g^T, .]`. The diagonal block of a frontal variable holds all its edges,
    /// also those to variables eliminated earlier: the updates of these variables subtract what they account for.
    #[inline(always)]
    fn eliminate_clique(
        &mut self,
        tree: &mut Tree,
        index: usize,
        edges: &impl Incidence<D>,
        deltas: &[SVector<f64, D>],
    ) {
        let mut clique = tree.take(index);
        let columns = clique.frontals * D;
        self.held.clear();
        self.held.resize(columns, false);
        clique.undetermined.clear();
        // One round is nearly always enough. Each further round holds one more direction, and after `SINGLE_ROUNDS` twice as
        // many as the round before: otherwise a clique with hundreds of ill-conditioned directions would take hundreds of
        // rounds.
        let mut most = 1;
        for round in 0.. {
            let Some(failure) = self.attempt(tree, &mut clique, edges, deltas) else { break };
            if self.held[failure.column] {
                // Numbers have overflowed: the equations of this clique are of no use.
                hold_all(&mut clique, deltas);
                break;
            }
            if round >= SINGLE_ROUNDS {
                most *= 2;
            }
            for column in self.failing(&failure, &clique.panel, most) {
                self.held[column] = true;
                let node = clique.variables[column / D];
                if clique.undetermined.last() != Some(&node) {
                    clique.undetermined.push(node);
                }
            }
        }
        tree.put_back(index, clique);
    }

    /// Eliminates the front and returns the first column whose direction is undetermined, if there is one.
    #[inline(always)]
    fn attempt(
        &mut self,
        tree: &Tree,
        clique: &mut Clique,
        edges: &impl Incidence<D>,
        deltas: &[SVector<f64, D>],
    ) -> Option<Failure> {
        self.stamp += 1;
        for (place, &node) in clique.variables.iter().enumerate() {
            self.place[node] = place;
            self.clique[node] = self.stamp;
        }
        let columns = clique.frontals * D;
        let height = clique.variables.len() * D + 1;
        let below = height - columns;
        let Clique { panel, update, variables, .. } = clique;
        panel.clear();
        panel.resize(columns * height, 0.0);
        update.clear();
        update.resize(below * below, 0.0);
        self.diagonal.clear();
        for (place, &node) in variables[..clique.frontals].iter().enumerate() {
            self.assemble_node(panel, height, place, node, edges);
        }
        if self.held.contains(&true) {
            // Translations and rotations have different units, so each kind has its own stiffness.
            let stiffness = [true, false].map(|along| {
                let alike = (0..columns).filter(|column| (column % D < translations(D)) == along);
                let largest = alike.map(|column| self.diagonal[column]).fold(0.0, f64::max);
                if largest > 0.0 { largest } else { 1.0 }
            });
            for (column, _) in self.held.iter().enumerate().filter(|&(_, &held)| held) {
                let stiffness = stiffness[usize::from(column % D >= translations(D))];
                panel[column * height + column] += stiffness;
                panel[column * height + height - 1] += stiffness * deltas[variables[column / D]][column % D];
                self.diagonal[column] += stiffness;
            }
        }
        let mut front = FrontView { panel, height, columns, update, fresh: clique.children.is_empty() };
        for &child in &clique.children {
            self.add_child(tree.clique(child), front.reborrow());
        }
        if let Err(column) = eliminate::<D>(front.reborrow(), &mut self.scratch) {
            return Some(Failure { column: self.not_held(column), height, broke_down: true });
        }
        let column = (0..columns).find(|&column| self.is_singular(front.panel, height, column))?;
        Some(Failure { column, height, broke_down: false })
    }

    /// Whether elimination has left only rounding of a column's diagonal entry; false for a column that is held.
    #[inline(always)]
    fn is_singular(&self, panel: &[f64], height: usize, column: usize) -> bool {
        let pivot = panel[column * height + column];
        !(pivot * pivot > SINGULAR * self.diagonal[column]) && !self.held[column]
    }

    /// The columns to hold after a failure, at most `most`: the failed column, then later ones that failed too. If
    /// elimination broke down, nothing is known of later columns: then the next ones that are not held.
    fn failing(&self, failure: &Failure, panel: &[f64], most: usize) -> Vec<usize> {
        let Failure { column, height, broke_down } = *failure;
        let others = (column + 1..self.held.len()).filter(|&other| {
            if broke_down { !self.held[other] } else { self.is_singular(panel, height, other) }
        });
        std::iter::once(column).chain(others).take(most).collect()
    }

    /// The column to hold after elimination broke down at `column`: this column or, if it is held already, the next one that
    /// is not. So every round holds one more.
    fn not_held(&self, column: usize) -> usize {
        let count = self.held.len();
        (0..count)
            .map(|offset| (column + offset) % count)
            .find(|&column| !self.held[column])
            .unwrap_or(column)
    }

    /// Writes a frontal variable's block column and right-hand side.
    #[inline(always)]
    fn assemble_node(
        &mut self,
        panel: &mut [f64],
        height: usize,
        place: usize,
        node: usize,
        edges: &impl Incidence<D>,
    ) {
        let mut diagonal = SMatrix::<f64, D, D>::zeros();
        let mut gradient = SVector::<f64, D>::zeros();
        edges.for_each(node, |other, model, is_from| {
            let row = if self.clique[other] == self.stamp { self.place[other] } else { 0 };
            if is_from {
                diagonal += model.from_from;
                gradient += model.from_gradient;
                if row > place {
                    add_block(panel, height, row, place, &model.from_to.transpose());
                }
            } else {
                diagonal += model.to_to;
                gradient += model.to_gradient;
                if row > place {
                    add_block(panel, height, row, place, &model.from_to);
                }
            }
        });
        add_block(panel, height, place, place, &diagonal);
        for component in 0..D {
            panel[(place * D + component) * height + height - 1] = -gradient[component];
            self.diagonal.push(diagonal[(component, component)]);
        }
    }

    /// Adds a child's update to the front.
    #[inline(always)]
    fn add_child(&mut self, child: &Clique, front: FrontView<'_>) {
        let separator = &child.variables[child.frontals..];
        let ascends = separator.windows(2).all(|pair| self.place[pair[0]] < self.place[pair[1]]);
        if !ascends {
            self.add_unsorted_child(child, front);
            return;
        }
        self.runs.clear();
        for (index, &node) in separator.iter().enumerate() {
            push_rows(&mut self.runs, index * D, self.place[node] * D, D);
        }
        // The right-hand side.
        let order = separator.len() * D + 1;
        push_rows(&mut self.runs, order - 1, front.height - 1, 1);
        extend_add(&child.update, order, 0..order, &self.runs, front);
    }

    /// Adds the update of a child whose separator is no longer in the order of elimination.
    #[inline(always)]
    fn add_unsorted_child(&self, child: &Clique, front: FrontView<'_>) {
        let below = front.below();
        let FrontView { panel, height, columns, update, .. } = front;
        let separator = &child.variables[child.frontals..];
        let order = separator.len() * D + 1;
        // Block by block: the two positions are compared once for all entries of a block.
        for (block_column, &node) in separator.iter().enumerate() {
            let column = self.place[node] * D;
            let values = |component: usize| &child.update[(block_column * D + component) * order..][..order];
            for (offset, &node) in separator[block_column..].iter().enumerate() {
                let (source, row) = ((block_column + offset) * D, self.place[node] * D);
                for component in 0..D {
                    let block = &values(component)[source..source + D];
                    // Only the lower triangle of a diagonal block is valid.
                    let first = if offset == 0 { component } else { 0 };
                    for (along, value) in block.iter().enumerate().skip(first) {
                        let (target, below_target) = if row >= column {
                            (column + component, row + along)
                        } else {
                            (row + along, column + component)
                        };
                        if target < columns {
                            panel[target * height + below_target] += value;
                        } else {
                            update[(target - columns) * below + below_target - columns] += value;
                        }
                    }
                }
            }
            for component in 0..D {
                let value = values(component)[order - 1];
                if column < columns {
                    panel[(column + component) * height + height - 1] += value;
                } else {
                    update[(column + component - columns) * below + below - 1] += value;
                }
            }
        }
    }
}

/// [`Elimination::eliminate`] for one set of vector instructions. Not a closure: a closure would not be inlined, and the
/// functions it calls would be compiled for the baseline instruction set.
struct Eliminate<'a, E, const D: usize> {
    elimination: &'a mut Elimination<D>,
    tree: &'a mut Tree,
    cliques: &'a [usize],
    edges: &'a E,
    /// The current linear updates; held directions keep theirs.
    deltas: &'a [SVector<f64, D>],
}

impl<E: Incidence<D>, const D: usize> WithSimd for Eliminate<'_, E, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for &clique in self.cliques {
            self.elimination.eliminate_clique(self.tree, clique, self.edges, self.deltas);
        }
    }
}

/// Makes a clique that keeps the linear updates of all its frontal variables.
fn hold_all<const D: usize>(clique: &mut Clique, deltas: &[SVector<f64, D>]) {
    let columns = clique.frontals * D;
    let height = columns + clique.update.len().isqrt();
    clique.panel.fill(0.0);
    clique.update.fill(0.0);
    for column in 0..columns {
        clique.panel[column * height + column] = 1.0;
        clique.panel[column * height + height - 1] = deltas[clique.variables[column / D]][column % D];
    }
}

/// Adds a block at block position `(row, column)` of a column-major panel.
#[inline(always)]
fn add_block<const D: usize>(
    panel: &mut [f64],
    height: usize,
    row: usize,
    column: usize,
    block: &SMatrix<f64, D, D>,
) {
    for (offset, source) in block.as_slice().chunks_exact(D).enumerate() {
        let start = (column * D + offset) * height + row * D;
        for (sum, value) in panel[start..start + D].iter_mut().zip(source) {
            *sum += value;
        }
    }
}

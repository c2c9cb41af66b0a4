//! The numeric elimination of one clique.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::dyn_stack::MemBuffer;
use nalgebra::{SMatrix, SVector};

use super::tree::{Clique, Tree};
use crate::cholesky::dense;
use crate::residual::Linearised;

/// Share of a diagonal entry that elimination must leave: below it the direction is undetermined.
const SINGULAR: f64 = 1e-14;

/// The linearised edges at a node, as seen from it.
pub(super) trait Incidence<const D: usize> {
    /// Calls back with the edge's other end, the model, and whether the node is the edge's `from`.
    fn for_each(&self, node: usize, each: impl FnMut(usize, &Linearised<D>, bool));
}

/// Memory of elimination.
pub(super) struct Elimination<const D: usize> {
    /// Place of each node in the clique that is being made.
    place: Vec<usize>,
    /// The clique for which the place was set.
    clique: Vec<usize>,
    stamp: usize,
    scratch: MemBuffer,
    scratch_columns: usize,
    diagonal: Vec<f64>,
    held: Vec<bool>,
    runs: Vec<Run>,
}

/// A stretch of a child's rows that lies together in the parent's front, too. Scalars.
#[derive(Clone, Copy)]
struct Run {
    source: usize,
    target: usize,
    length: usize,
}

impl<const D: usize> std::fmt::Debug for Elimination<D> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Elimination").finish_non_exhaustive()
    }
}

impl<const D: usize> Elimination<D> {
    pub(super) fn new() -> Self {
        Self {
            place: Vec::new(),
            clique: Vec::new(),
            stamp: 0,
            scratch: dense::scratch(0),
            scratch_columns: 0,
            diagonal: Vec::new(),
            held: Vec::new(),
            runs: Vec::new(),
        }
    }

    pub(super) fn add_node(&mut self) {
        self.place.push(0);
        self.clique.push(0);
    }

    /// Assembles a clique of edges and children, and eliminates its frontal variables.
    ///
    /// The front is the lower triangle of `[H, -g; -g^T, .]`. Its diagonal blocks hold all edges of a frontal variable, also
    /// those to variables eliminated before, whose updates take away their part.
    #[inline(always)]
    pub(super) fn eliminate(&mut self, tree: &mut Tree, index: usize, edges: &impl Incidence<D>) {
        let mut clique = tree.take(index);
        let columns = clique.frontals * D;
        if columns > self.scratch_columns {
            self.scratch_columns = columns.next_power_of_two();
            self.scratch = dense::scratch(self.scratch_columns);
        }
        self.held.clear();
        self.held.resize(columns, false);
        clique.undetermined.clear();
        // Each round holds one more direction; nearly always there is one round.
        while let Some(column) = self.attempt(tree, &mut clique, edges) {
            if std::mem::replace(&mut self.held[column], true) {
                // Numbers have overflowed: nothing can be learnt from this clique.
                hold_all(&mut clique, columns);
                break;
            }
            let node = clique.variables[column / D];
            if clique.undetermined.last() != Some(&node) {
                clique.undetermined.push(node);
            }
        }
        tree.put_back(index, clique);
    }

    /// Eliminates the front and returns a column whose direction is undetermined, if there is one.
    #[inline(always)]
    fn attempt(&mut self, tree: &Tree, clique: &mut Clique, edges: &impl Incidence<D>) -> Option<usize> {
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
            let largest = self.diagonal.iter().copied().fold(0.0, f64::max);
            let stiffness = if largest > 0.0 { largest } else { 1.0 };
            for (column, _) in self.held.iter().enumerate().filter(|&(_, &held)| held) {
                panel[column * height + column] += stiffness;
                self.diagonal[column] += stiffness;
            }
        }
        let fresh = clique.children.is_empty();
        for &child in &clique.children {
            self.add_child(tree.clique(child), panel, height, columns, update);
        }
        if let Err(column) = dense::eliminate::<D>(panel, height, columns, update, fresh, &mut self.scratch) {
            return Some(self.not_held(column));
        }
        (0..columns).find(|&column| {
            let pivot = panel[column * height + column];
            !(pivot * pivot > SINGULAR * self.diagonal[column]) && !self.held[column]
        })
    }

    /// The column to hold after elimination broke down there: itself, or, where it is held already, the next one that is
    /// not, so that every round holds one more.
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
    fn add_child(
        &mut self,
        child: &Clique,
        panel: &mut [f64],
        height: usize,
        columns: usize,
        update: &mut [f64],
    ) {
        let separator = &child.variables[child.frontals..];
        let order = separator.len() * D + 1;
        let below = height - columns;
        let ascends = separator.windows(2).all(|pair| self.place[pair[0]] < self.place[pair[1]]);
        if !ascends {
            self.add_unsorted_child(child, panel, height, columns, update);
            return;
        }
        self.runs.clear();
        for (index, &node) in separator.iter().enumerate() {
            let target = self.place[node] * D;
            match self.runs.last_mut() {
                Some(run) if run.target + run.length == target => run.length += D,
                _ => self.runs.push(Run { source: index * D, target, length: D }),
            }
        }
        match self.runs.last_mut() {
            Some(run) if run.target + run.length == height - 1 => run.length += 1,
            _ => self.runs.push(Run { source: order - 1, target: height - 1, length: 1 }),
        }
        let mut first = 0;
        for (source, values) in child.update.chunks_exact(order).enumerate() {
            while self.runs[first].source + self.runs[first].length <= source {
                first += 1;
            }
            let run = self.runs[first];
            let column = run.target + source - run.source;
            let (target, skipped) = if column < columns {
                (&mut panel[column * height..][..height], 0)
            } else {
                (&mut update[(column - columns) * below..][..below], columns)
            };
            for run in &self.runs[first..] {
                let above = source.saturating_sub(run.source);
                let values = &values[run.source + above..run.source + run.length];
                let sums = &mut target[run.target + above - skipped..][..values.len()];
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += value;
                }
            }
        }
    }

    /// Adds the update of a child whose separator has been put in another order since.
    fn add_unsorted_child(
        &self,
        child: &Clique,
        panel: &mut [f64],
        height: usize,
        columns: usize,
        update: &mut [f64],
    ) {
        let separator = &child.variables[child.frontals..];
        let order = separator.len() * D + 1;
        let below = height - columns;
        let place = |scalar: usize| {
            separator.get(scalar / D).map_or(height - 1, |&node| self.place[node] * D + scalar % D)
        };
        for (source, values) in child.update.chunks_exact(order).enumerate() {
            let column = place(source);
            for (row, &value) in values.iter().enumerate().skip(source) {
                let row = place(row);
                let (column, row) = (column.min(row), column.max(row));
                if column < columns {
                    panel[column * height + row] += value;
                } else {
                    update[(column - columns) * below + row - columns] += value;
                }
            }
        }
    }
}

/// Makes a clique of which all frontal variables stay where they are.
fn hold_all(clique: &mut Clique, columns: usize) {
    let height = columns + clique.update.len().isqrt();
    clique.panel.fill(0.0);
    clique.update.fill(0.0);
    for column in 0..columns {
        clique.panel[column * height + column] = 1.0;
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

//! The numeric phase: multifrontal factorisation and triangular solves.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::dyn_stack::MemBuffer;
use faer::traits::pulp::{Arch, Simd, WithSimd};
use nalgebra::SMatrix;
use thiserror::Error;

use super::dense;
use super::extend_add::{Run, extend_add, push_rows, rows_before};
use super::symbolic::{Front, Symbolic};

/// The matrix is not positive definite.
#[derive(Clone, Debug, Error, PartialEq)]
#[error(
    "the matrix is not positive definite: nothing positive is left of component {component} of variable {variable}"
)]
pub struct Breakdown {
    /// Variable whose pivot failed.
    pub variable: usize,
    /// Component of that variable, from 0.
    pub component: usize,
}

/// Memory and values of a factor with blocks of order `D`: `P A P^T = L L^T`.
pub struct Factor<const D: usize> {
    pub(crate) panels: Vec<f64>,
    stacks: [Vec<f64>; 2],
    memory: MemBuffer,
    pub(super) permuted: Vec<f64>,
    /// A front's part of a vector.
    pub(super) local: Vec<f64>,
    runs: Vec<Run>,
    /// Smallest share that elimination has left of a diagonal entry, and where.
    smallest_pivot: (f64, usize, usize),
}

impl<const D: usize> std::fmt::Debug for Factor<D> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Factor").field("scalars", &self.panels.len()).finish_non_exhaustive()
    }
}

impl<const D: usize> Factor<D> {
    /// Reserves all memory that factorising and solving with this pattern need.
    pub fn new(symbolic: &Symbolic) -> Self {
        let columns = symbolic.fronts.iter().map(|front| front.columns).max().unwrap_or(0);
        let height = symbolic.fronts.iter().map(Front::height).max().unwrap_or(0);
        Self {
            panels: vec![0.0; symbolic.panel_blocks * D * D],
            stacks: symbolic.stack_blocks.map(|blocks| vec![0.0; blocks * D * D]),
            memory: dense::scratch(columns * D),
            permuted: vec![0.0; symbolic.variables() * D],
            local: vec![0.0; height * D],
            runs: Vec::with_capacity(height),
            smallest_pivot: (1.0, 0, 0),
        }
    }

    /// Lends the memory to a factor of blocks that are no larger, with the same pattern; the values are lost.
    pub(crate) fn lend<const E: usize, T>(&mut self, work: impl FnOnce(&mut Factor<E>) -> T) -> T {
        debug_assert!(E <= D, "memory for smaller blocks is lent");
        let mut other = Factor::<E>::empty();
        self.exchange(&mut other);
        let result = work(&mut other);
        self.exchange(&mut other);
        result
    }

    fn exchange<const E: usize>(&mut self, other: &mut Factor<E>) {
        std::mem::swap(&mut self.panels, &mut other.panels);
        std::mem::swap(&mut self.stacks, &mut other.stacks);
        std::mem::swap(&mut self.memory, &mut other.memory);
        std::mem::swap(&mut self.permuted, &mut other.permuted);
        std::mem::swap(&mut self.local, &mut other.local);
        std::mem::swap(&mut self.runs, &mut other.runs);
    }

    fn empty() -> Self {
        Self {
            panels: Vec::new(),
            stacks: [Vec::new(), Vec::new()],
            memory: dense::scratch(0),
            permuted: Vec::new(),
            local: Vec::new(),
            runs: Vec::new(),
            smallest_pivot: (1.0, 0, 0),
        }
    }

    /// Factorises the matrix with these diagonal blocks and off-diagonal blocks (row: first of its pair).
    ///
    /// `damping` is added to every diagonal entry as a multiple of that entry, after it was raised to at least
    /// `floor`: `A + damping * max(diag A, floor)`.
    pub fn factorize(
        &mut self,
        symbolic: &Symbolic,
        diagonal: &[SMatrix<f64, D, D>],
        off_diagonal: &[SMatrix<f64, D, D>],
        damping: f64,
        floor: f64,
    ) -> Result<(), Breakdown> {
        // The widest vector instructions of the machine, chosen here once for all loops that are inlined below.
        Arch::new().dispatch(Factorize { factor: self, symbolic, diagonal, off_diagonal, damping, floor })
    }

    #[inline(always)]
    fn factorize_fronts(
        &mut self,
        symbolic: &Symbolic,
        diagonal: &[SMatrix<f64, D, D>],
        off_diagonal: &[SMatrix<f64, D, D>],
        damping: f64,
        floor: f64,
    ) -> Result<(), Breakdown> {
        self.smallest_pivot = (1.0, 0, 0);
        for front in &symbolic.fronts {
            let height = front.height() * D;
            let panel_start = front.panel * D * D;
            let panel = &mut self.panels[panel_start..panel_start + front.columns * D * height];
            panel.fill(0.0);
            for local in 0..front.columns {
                let mut block = diagonal[symbolic.order[front.first + local]];
                for component in 0..D {
                    block[(component, component)] += damping * block[(component, component)].max(floor);
                }
                write_block(panel, height, local, local, &block);
            }
            for entry in &symbolic.entries[front.entries.clone()] {
                let block = &off_diagonal[entry.pair];
                if entry.transposed {
                    write_block(panel, height, entry.row, entry.column, &block.transpose());
                } else {
                    write_block(panel, height, entry.row, entry.column, block);
                }
            }
            let [even, odd] = &mut self.stacks;
            let (own, others) = if front.stack == 0 { (even, &*odd) } else { (odd, &*even) };
            let below = front.below() * D;
            let update_start = front.update * D * D;
            let update = &mut own[update_start..update_start + below * below];
            let columns = front.columns * D;
            for &child in &symbolic.children[front.children.clone()] {
                let child = &symbolic.fronts[child];
                place_rows::<D>(symbolic, child, &mut self.runs);
                let eliminated = 0..rows_before(&self.runs, columns);
                let (child, order) = update_of::<D>(child, others);
                extend_add(child, order, eliminated, &self.runs, (panel, height, columns), update);
            }
            dense::eliminate::<D>(panel, height, columns, update, true, &mut self.memory).map_err(
                |column| Breakdown {
                    variable: symbolic.order[front.first + column / D],
                    component: column % D,
                },
            )?;
            // The update takes the children's after its own part, so that it is written once less.
            for &child in &symbolic.children[front.children.clone()] {
                let child = &symbolic.fronts[child];
                place_rows::<D>(symbolic, child, &mut self.runs);
                let (child, order) = update_of::<D>(child, others);
                let rest = rows_before(&self.runs, columns)..order;
                extend_add(child, order, rest, &self.runs, (panel, height, columns), update);
            }
            self.note_pivots(symbolic, front, diagonal, damping, floor);
        }
        Ok(())
    }

    /// Keeps the smallest ratio of a pivot to the matrix's diagonal entry.
    fn note_pivots(
        &mut self,
        symbolic: &Symbolic,
        front: &Front,
        diagonal: &[SMatrix<f64, D, D>],
        damping: f64,
        floor: f64,
    ) {
        let height = front.height() * D;
        for column in 0..front.columns * D {
            let variable = symbolic.order[front.first + column / D];
            let entry = diagonal[variable][(column % D, column % D)];
            let pivot = self.panels[front.panel * D * D + column * height + column];
            let share = pivot * pivot / (entry + damping * entry.max(floor));
            // A share of NaN, from an overflow, is kept as the smallest of all.
            if share < self.smallest_pivot.0 || share.is_nan() {
                self.smallest_pivot = (share, variable, column % D);
            }
        }
    }

    /// The smallest share `L_kk^2 / A_kk` that elimination left of a diagonal entry, with its variable and component.
    ///
    /// Near the unit round-off the matrix is singular to working precision.
    pub fn smallest_pivot(&self) -> (f64, usize, usize) {
        self.smallest_pivot
    }
}

/// [`Factor::factorize`] for one set of vector instructions. Not a closure: the call of one is not inlined, and what it calls
/// would be compiled for the least of all machines.
struct Factorize<'a, const D: usize> {
    factor: &'a mut Factor<D>,
    symbolic: &'a Symbolic,
    diagonal: &'a [SMatrix<f64, D, D>],
    off_diagonal: &'a [SMatrix<f64, D, D>],
    damping: f64,
    floor: f64,
}

impl<const D: usize> WithSimd for Factorize<'_, D> {
    type Output = Result<(), Breakdown>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.factor.factorize_fronts(
            self.symbolic,
            self.diagonal,
            self.off_diagonal,
            self.damping,
            self.floor,
        )
    }
}

/// Copies a block to block position `(row, column)` of a column-major panel.
#[inline(always)]
fn write_block<const D: usize>(
    panel: &mut [f64],
    height: usize,
    row: usize,
    column: usize,
    block: &SMatrix<f64, D, D>,
) {
    for (offset, source) in block.as_slice().chunks_exact(D).enumerate() {
        let start = (column * D + offset) * height + row * D;
        panel[start..start + D].copy_from_slice(source);
    }
}

/// Where a child's rows lie in its parent's front.
#[inline(always)]
fn place_rows<const D: usize>(symbolic: &Symbolic, child: &Front, runs: &mut Vec<Run>) {
    runs.clear();
    for (index, &place) in symbolic.relative[child.rows.clone()].iter().enumerate() {
        push_rows(runs, index * D, place * D, D);
    }
}

/// A front's update matrix on its stack, and its order.
#[inline(always)]
fn update_of<'a, const D: usize>(front: &Front, stack: &'a [f64]) -> (&'a [f64], usize) {
    let order = front.below() * D;
    (&stack[front.update * D * D..][..order * order], order)
}

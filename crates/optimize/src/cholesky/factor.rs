//! The numeric phase: multifrontal factorisation and triangular solves.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::dyn_stack::MemBuffer;
use faer::traits::pulp::{Arch, Simd, WithSimd};
use nalgebra::{SMatrix, SVector};
use thiserror::Error;

use super::dense;
use super::extend_add::{Run, extend_add, push_rows};
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
    pub(super) below: Vec<f64>,
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
        let below = symbolic.fronts.iter().map(Front::below).max().unwrap_or(0);
        Self {
            panels: vec![0.0; symbolic.panel_blocks * D * D],
            stacks: symbolic.stack_blocks.map(|blocks| vec![0.0; blocks * D * D]),
            memory: dense::scratch(columns * D),
            permuted: vec![0.0; symbolic.variables() * D],
            below: vec![0.0; below * D],
            runs: Vec::with_capacity(below),
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
            let fresh = front.children.is_empty();
            if !fresh {
                update.fill(0.0);
            }
            for &child in &symbolic.children[front.children.clone()] {
                let child = &symbolic.fronts[child];
                let places = &symbolic.relative[child.rows.clone()];
                self.runs.clear();
                for (index, &place) in places.iter().enumerate() {
                    push_rows(&mut self.runs, index * D, place * D, D);
                }
                let order = places.len() * D;
                let source = &others[child.update * D * D..][..order * order];
                let columns = front.columns * D;
                extend_add(source, order, 0..order, &self.runs, (panel, height, columns), update);
            }
            dense::eliminate::<D>(panel, height, front.columns * D, update, fresh, &mut self.memory)
                .map_err(|column| Breakdown {
                    variable: symbolic.order[front.first + column / D],
                    component: column % D,
                })?;
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

    /// Solves `A x = b`; `values` holds `b` and becomes `x`.
    pub fn solve(&mut self, symbolic: &Symbolic, values: &mut [SVector<f64, D>]) {
        for (position, &variable) in symbolic.order.iter().enumerate() {
            self.permuted[position * D..(position + 1) * D].copy_from_slice(values[variable].as_slice());
        }
        Arch::new().dispatch(Substitute { factor: self, symbolic });
        for (position, &variable) in symbolic.order.iter().enumerate() {
            values[variable].as_mut_slice().copy_from_slice(&self.permuted[position * D..(position + 1) * D]);
        }
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

/// Both triangular solves, in the same way.
struct Substitute<'a, const D: usize> {
    factor: &'a mut Factor<D>,
    symbolic: &'a Symbolic,
}

impl<const D: usize> WithSimd for Substitute<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Factor { panels, permuted, below, .. } = self.factor;
        for front in &self.symbolic.fronts {
            forward::<D>(self.symbolic, front, panels, permuted, below);
        }
        for front in self.symbolic.fronts.iter().rev() {
            backward::<D>(self.symbolic, front, panels, permuted, below);
        }
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

/// `x_1 = L^-1 x_1`, then `x_2 -= M x_1`, for the columns of one front. `below` is working memory.
#[inline(always)]
pub(super) fn forward<const D: usize>(
    symbolic: &Symbolic,
    front: &Front,
    panels: &[f64],
    x: &mut [f64],
    below: &mut [f64],
) {
    let height = front.height() * D;
    let panel = &panels[front.panel * D * D..][..front.columns * D * height];
    let (before, after) = x.split_at_mut((front.first + front.columns) * D);
    let own = &mut before[front.first * D..];
    let columns = own.len();
    let offset = (front.first + front.columns) * D;
    let below = &mut below[..height - columns];
    below.fill(0.0);
    for (block_index, block) in panel.chunks_exact(D * height).enumerate() {
        let start = block_index * D;
        let mut solved = [0.0; D];
        for column in 0..D {
            let values = &block[column * height..][..height];
            let value = own[start + column] / values[start + column];
            own[start + column] = value;
            solved[column] = value;
            for (target, entry) in
                own[start + column + 1..].iter_mut().zip(&values[start + column + 1..columns])
            {
                *target -= value * entry;
            }
        }
        let sources: [&[f64]; D] =
            std::array::from_fn(|column| &block[column * height + columns..][..below.len()]);
        for (index, target) in below.iter_mut().enumerate() {
            let mut sum = 0.0;
            for column in 0..D {
                sum += sources[column][index] * solved[column];
            }
            *target += sum;
        }
    }
    for (&row, values) in symbolic.rows[front.rows.clone()].iter().zip(below.chunks_exact(D)) {
        for (target, value) in after[row * D - offset..][..D].iter_mut().zip(values) {
            *target -= value;
        }
    }
}

/// `x_1 = L^-T (x_1 - M^T x_2)` for the columns of one front. `below` is working memory.
#[inline(always)]
pub(super) fn backward<const D: usize>(
    symbolic: &Symbolic,
    front: &Front,
    panels: &[f64],
    x: &mut [f64],
    below: &mut [f64],
) {
    let height = front.height() * D;
    let panel = &panels[front.panel * D * D..][..front.columns * D * height];
    let (before, after) = x.split_at_mut((front.first + front.columns) * D);
    let own = &mut before[front.first * D..];
    let columns = own.len();
    let offset = (front.first + front.columns) * D;
    let below = &mut below[..height - columns];
    for (&row, values) in symbolic.rows[front.rows.clone()].iter().zip(below.chunks_exact_mut(D)) {
        values.copy_from_slice(&after[row * D - offset..][..D]);
    }
    for (block_index, block) in panel.chunks_exact(D * height).enumerate().rev() {
        let start = block_index * D;
        // D sums at a time: one alone would wait for its own last addition.
        let sources: [&[f64]; D] =
            std::array::from_fn(|column| &block[column * height + columns..][..below.len()]);
        let mut sums = [0.0; D];
        for (index, &known) in below.iter().enumerate() {
            for column in 0..D {
                sums[column] += sources[column][index] * known;
            }
        }
        for column in (0..D).rev() {
            let values = &block[column * height..][..height];
            let mut sum = own[start + column] - sums[column];
            for (known, value) in own[start + column + 1..].iter().zip(&values[start + column + 1..columns]) {
                sum -= known * value;
            }
            own[start + column] = sum / values[start + column];
        }
    }
}

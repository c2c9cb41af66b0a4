//! The numeric phase: multifrontal factorisation and triangular solves.

use faer::dyn_stack::MemBuffer;
use nalgebra::{SMatrix, SVector};
use thiserror::Error;

use super::dense;
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
    permuted: Vec<f64>,
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
        Self {
            panels: vec![0.0; symbolic.panel_blocks * D * D],
            stacks: symbolic.stack_blocks.map(|blocks| vec![0.0; blocks * D * D]),
            memory: dense::scratch(columns * D),
            permuted: vec![0.0; symbolic.variables() * D],
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
            update.fill(0.0);
            for &child in &symbolic.children[front.children.clone()] {
                extend_add::<D>(symbolic, &symbolic.fronts[child], front, others, panel, update);
            }
            // Assembled diagonal entries less what the children took: a front's own share is judged after it.
            dense::eliminate::<D>(panel, height, front.columns * D, update, &mut self.memory).map_err(
                |column| Breakdown {
                    variable: symbolic.order[front.first + column / D],
                    component: column % D,
                },
            )?;
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
        for front in &symbolic.fronts {
            forward::<D>(symbolic, front, &self.panels, &mut self.permuted);
        }
        for front in symbolic.fronts.iter().rev() {
            backward::<D>(symbolic, front, &self.panels, &mut self.permuted);
        }
        for (position, &variable) in symbolic.order.iter().enumerate() {
            values[variable].as_mut_slice().copy_from_slice(&self.permuted[position * D..(position + 1) * D]);
        }
    }
}

/// Copies a block to block position `(row, column)` of a column-major panel.
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

/// Adds a child's update matrix to its parent's front.
fn extend_add<const D: usize>(
    symbolic: &Symbolic,
    child: &Front,
    parent: &Front,
    stack: &[f64],
    panel: &mut [f64],
    update: &mut [f64],
) {
    let relative = &symbolic.relative[child.rows.clone()];
    let order = relative.len() * D;
    let source = &stack[child.update * D * D..][..order * order];
    let (height, below) = (parent.height() * D, parent.below() * D);
    for (block_column, &place) in relative.iter().enumerate() {
        for component in 0..D {
            let column = &source[(block_column * D + component) * order..][..order];
            let (target, skipped) = if place < parent.columns {
                (&mut panel[(place * D + component) * height..][..height], 0)
            } else {
                let start = ((place - parent.columns) * D + component) * below;
                (&mut update[start..start + below], parent.columns)
            };
            for (values, &row) in column.chunks_exact(D).zip(relative).skip(block_column) {
                let start = (row - skipped) * D;
                for (sum, value) in target[start..start + D].iter_mut().zip(values) {
                    *sum += value;
                }
            }
        }
    }
}

/// `x_1 = L^-1 x_1`, then `x_2 -= M x_1`, for the columns of one front.
fn forward<const D: usize>(symbolic: &Symbolic, front: &Front, panels: &[f64], x: &mut [f64]) {
    let height = front.height() * D;
    let panel = &panels[front.panel * D * D..][..front.columns * D * height];
    let (before, after) = x.split_at_mut((front.first + front.columns) * D);
    let own = &mut before[front.first * D..];
    let offset = (front.first + front.columns) * D;
    let columns = own.len();
    for (column, values) in panel.chunks_exact(height).enumerate() {
        let solved = own[column] / values[column];
        own[column] = solved;
        for (target, value) in own[column + 1..].iter_mut().zip(&values[column + 1..columns]) {
            *target -= solved * value;
        }
        for (&row, block) in symbolic.rows[front.rows.clone()].iter().zip(values[columns..].chunks_exact(D)) {
            for (target, value) in after[row * D - offset..][..D].iter_mut().zip(block) {
                *target -= solved * value;
            }
        }
    }
}

/// `x_1 = L^-T (x_1 - M^T x_2)` for the columns of one front.
fn backward<const D: usize>(symbolic: &Symbolic, front: &Front, panels: &[f64], x: &mut [f64]) {
    let height = front.height() * D;
    let panel = &panels[front.panel * D * D..][..front.columns * D * height];
    let (before, after) = x.split_at_mut((front.first + front.columns) * D);
    let own = &mut before[front.first * D..];
    let offset = (front.first + front.columns) * D;
    let columns = own.len();
    for (column, values) in panel.chunks_exact(height).enumerate().rev() {
        let mut sum = own[column];
        for (&row, block) in symbolic.rows[front.rows.clone()].iter().zip(values[columns..].chunks_exact(D)) {
            for (known, value) in after[row * D - offset..][..D].iter().zip(block) {
                sum -= known * value;
            }
        }
        for (known, value) in own[column + 1..].iter().zip(&values[column + 1..columns]) {
            sum -= known * value;
        }
        own[column] = sum / values[column];
    }
}

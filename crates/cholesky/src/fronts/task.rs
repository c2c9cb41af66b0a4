//! The factorisation of a stretch of fronts, by one thread.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::ops::Range;

use nalgebra::SMatrix;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::breakdown::Breakdown;
use super::dense::{self, Scratch};
use super::extend_add::{Run, extend_add, push_rows, rows_before};
use super::stored::Stored;
use super::view::FrontView;
use super::workspaces::Workspaces;
use crate::instructions::for_small_blocks;
use crate::matrix::Matrix;
use crate::symbolic::{Front, Stretch, Symbolic};

/// The smallest remaining share of a diagonal entry after elimination, and its position.
#[derive(Clone, Copy)]
pub(super) struct SmallestPivot {
    pub(super) share: f64,
    pub(super) variable: usize,
    pub(super) component: usize,
}

impl Default for SmallestPivot {
    fn default() -> Self {
        Self { share: 1.0, variable: usize::MAX, component: 0 }
    }
}

impl SmallestPivot {
    /// Keeps the smaller share; of equal ones, that of the first variable. A share of NaN, from an overflow, counts as the
    /// smallest.
    #[inline(always)]
    pub(super) fn note(&mut self, other: Self) {
        if other.share > self.share {
            return;
        }
        let key = |pivot: &Self| {
            let share = if pivot.share.is_nan() { f64::NEG_INFINITY } else { pivot.share };
            (share, pivot.variable, pivot.component)
        };
        if key(&other) < key(self) {
            *self = other;
        }
    }
}

/// Working memory of a thread.
pub(super) struct Worker {
    memory: Scratch,
    runs: Vec<Run>,
    pub(super) smallest_pivot: SmallestPivot,
}

impl Worker {
    pub(super) fn new<const D: usize>(symbolic: &Symbolic, stretch: &Stretch) -> Self {
        let fronts = || stretch.fronts.iter().map(|&front| &symbolic.fronts[front]);
        let panels =
            fronts().map(|front| dense::panel_size(front.height() * D, front.columns * D)).max().unwrap_or(0);
        Self {
            memory: Scratch::with_panels(panels),
            runs: Vec::with_capacity(fronts().map(Front::height).max().unwrap_or(0)),
            smallest_pivot: SmallestPivot::default(),
        }
    }
}

/// Factorises independent stretches, on all threads, and moves the updates that they leave together. If several fail, reports the first
/// one in their order.
pub(super) fn side_by_side<const D: usize, S: Stored>(
    symbolic: &Symbolic,
    stretches: &[Stretch],
    matrix: Matrix<'_, D>,
    panels: &mut [S],
    stacks: &mut [Vec<f64>; 2],
    workers: &mut [Worker],
) -> Result<(), Breakdown> {
    let [even, odd] = &mut *stacks;
    let (mut panels, mut even, mut odd) = (Rest::new(panels), Rest::new(even), Rest::new(odd));
    let workspaces = Workspaces::of::<D, S>(symbolic, stretches);
    let scalars = |blocks: &Range<usize>| blocks.start * D * D..blocks.end * D * D;
    let tasks: Vec<Task<'_, D, S>> = stretches
        .iter()
        .zip(workers)
        .map(|(stretch, worker)| {
            let [of_even, of_odd] = [0, 1].map(|stack| scalars(&stretch.stacks[stack]));
            let of_panels = scalars(&stretch.panels);
            Task {
                symbolic,
                matrix,
                fronts: &stretch.fronts,
                panel_base: of_panels.start,
                panels: panels.cut(of_panels),
                stack_bases: [0, 1].map(|stack| scalars(&stretch.left[stack]).start),
                stacks: [even.cut(of_even), odd.cut(of_odd)],
                worker,
                workspaces: &workspaces,
            }
        })
        .collect();
    let outcomes: Vec<_> = tasks.into_par_iter().map(for_small_blocks).collect();
    // In ascending order nothing is overwritten that has not moved.
    for stretch in stretches {
        for (stack, (range, left)) in stacks.iter_mut().zip(stretch.stacks.iter().zip(&stretch.left)) {
            let (from, to) = (scalars(range).start, scalars(left));
            stack.copy_within(from..from + to.len(), to.start);
        }
    }
    outcomes.into_iter().collect()
}

/// The rest of a vector after ranges of it were cut out in ascending order.
pub(super) struct Rest<'a, T> {
    values: &'a mut [T],
    gone: usize,
}

impl<'a, T> Rest<'a, T> {
    pub(super) fn new(values: &'a mut [T]) -> Self {
        Self { values, gone: 0 }
    }

    pub(super) fn cut(&mut self, range: Range<usize>) -> &'a mut [T] {
        let (part, rest) = std::mem::take(&mut self.values).split_at_mut(range.end - self.gone);
        let part = &mut part[range.start - self.gone..];
        (self.values, self.gone) = (rest, range.end);
        part
    }
}

/// A stretch of fronts and its memory, for one set of vector instructions. Not a closure: a closure would not be inlined, and
/// the functions it calls would be compiled for the baseline instruction set.
pub(super) struct Task<'a, const D: usize, S> {
    pub(super) symbolic: &'a Symbolic,
    pub(super) matrix: Matrix<'a, D>,
    pub(super) fronts: &'a [usize],
    /// The factor from the scalar `panel_base` on.
    pub(super) panels: &'a mut [S],
    pub(super) panel_base: usize,
    /// The stacks, each from a scalar on.
    pub(super) stacks: [&'a mut [f64]; 2],
    pub(super) stack_bases: [usize; 2],
    pub(super) worker: &'a mut Worker,
    pub(super) workspaces: &'a Workspaces,
}

impl<const D: usize, N: Stored> WithSimd for Task<'_, D, N> {
    type Output = Result<(), Breakdown>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { symbolic, matrix, fronts, panels, panel_base, stacks, stack_bases, worker, workspaces } =
            self;
        let Matrix { diagonal, off_diagonal, damping, floor } = matrix;
        let Worker { memory, runs, smallest_pivot } = worker;
        // A front's panel, if it is not eliminated where it is stored.
        let mut workspace = workspaces.take();
        *smallest_pivot = SmallestPivot::default();
        let [even, odd] = stacks;
        for front in fronts.iter().map(|&front| &symbolic.fronts[front]) {
            let height = front.height() * D;
            let panel_start = front.panel * D * D - panel_base;
            let stored = &mut panels[panel_start..panel_start + front.columns * D * height];
            let (panel, stored) = N::places(stored, &mut workspace);
            panel.fill(0.0);
            for local in 0..front.columns {
                let mut block = diagonal[symbolic.order[front.first + local]];
                for component in 0..D {
                    block[(component, component)] +=
                        damping * block[(component, component)].max(floor[component]);
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
            let (own, others) = if front.stack == 0 { (&mut *even, &*odd) } else { (&mut *odd, &*even) };
            let (own_base, other_base) = (stack_bases[front.stack], stack_bases[1 - front.stack]);
            let below = front.below() * D;
            let update_start = front.update * D * D - own_base;
            let update = &mut own[update_start..update_start + below * below];
            let columns = front.columns * D;
            // The children are added to the panel first, since elimination needs complete columns. They are added to the
            // update matrix later: elimination first writes it as a product, which needs no zeroing.
            let mut view = FrontView { panel, height, columns, update, fresh: true };
            for &child in &symbolic.children[front.children.clone()] {
                let child = &symbolic.fronts[child];
                place_rows::<D>(symbolic, child, runs);
                let eliminated = 0..rows_before(runs, columns);
                let (child, order) = update_of::<D>(child, others, other_base);
                extend_add(child, order, eliminated, runs, view.reborrow());
            }
            dense::eliminate::<D>(view.reborrow(), memory).map_err(|column| Breakdown {
                variable: symbolic.order[front.first + column / D],
                component: column % D,
            })?;
            for &child in &symbolic.children[front.children.clone()] {
                let child = &symbolic.fronts[child];
                place_rows::<D>(symbolic, child, runs);
                let (child, order) = update_of::<D>(child, others, other_base);
                let rest = rows_before(runs, columns)..order;
                extend_add(child, order, rest, runs, view.reborrow());
            }
            // The squared pivot is compared with the matrix's diagonal entry, not with the largest pivot: this ratio does not
            // depend on the units of the variables, and small weights of some variables do not look singular.
            for column in 0..columns {
                let (variable, component) = (symbolic.order[front.first + column / D], column % D);
                let entry = diagonal[variable][(component, component)];
                let pivot = view.panel[column * height + column];
                let share = pivot * pivot / (entry + damping * entry.max(floor[component]));
                smallest_pivot.note(SmallestPivot { share, variable, component });
            }
            if let Some(stored) = stored {
                for (stored, value) in stored.iter_mut().zip(&*view.panel) {
                    *stored = N::narrowed(*value);
                }
            }
        }
        workspaces.give_back(workspace);
        Ok(())
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

/// Makes the runs of a child's rows in its parent's front.
#[inline(always)]
fn place_rows<const D: usize>(symbolic: &Symbolic, child: &Front, runs: &mut Vec<Run>) {
    runs.clear();
    for (index, &place) in symbolic.relative[child.rows.clone()].iter().enumerate() {
        push_rows(runs, index * D, place * D, D);
    }
}

/// A front's update matrix on its stack, and its order.
#[inline(always)]
fn update_of<'a, const D: usize>(front: &Front, stack: &'a [f64], base: usize) -> (&'a [f64], usize) {
    let order = front.below() * D;
    (&stack[front.update * D * D - base..][..order * order], order)
}

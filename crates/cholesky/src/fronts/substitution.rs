//! The triangular solves, front by front.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::SVector;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::dense::{products, subtract_columns};
use super::factor::Factor;
use super::stored::Stored;
use super::task::Rest;
use crate::instructions::for_small_blocks;
use crate::symbolic::{Front, Subtree, Symbolic};

/// The working memory of one subtree's solves.
pub(super) struct Solver {
    /// Values of the top's variables: in the forward solve, what the subtree adds to them; in the backward solve, a copy.
    top: Vec<f64>,
    local: Vec<f64>,
}

impl Solver {
    pub(super) fn new<const D: usize>(symbolic: &Symbolic, subtree: &Subtree) -> Self {
        let height = subtree.fronts.iter().map(|&front| symbolic.fronts[front].height()).max().unwrap_or(0);
        Self { top: vec![0.0; symbolic.top_variables() * D], local: vec![0.0; height * D] }
    }
}

impl<const D: usize, S: Stored> Factor<D, S> {
    /// Solves `A x = b`; `values` holds `b` and becomes `x`. Subtrees run in parallel, whatever the number of threads.
    pub fn solve(&mut self, symbolic: &Symbolic, values: &mut [SVector<f64, D>]) {
        for (value, &variable) in self.permuted.chunks_exact_mut(D).zip(&symbolic.order) {
            value.copy_from_slice(values[variable].as_slice());
        }
        let Self { panels, permuted, local, solvers, .. } = self;
        let panels: &[S] = bytemuck::cast_slice(panels);
        for solver in solvers.iter_mut() {
            solver.top.fill(0.0);
        }
        by_subtrees::<D, S>(symbolic, panels, permuted, solvers, Direction::Forward);
        // Where the values of a front above the subtrees are: in the vector, and in a solver's part of it.
        let range = |first: usize, front: &Front| first * D..(first + front.columns) * D;
        let top = symbolic.top.iter().map(|&front| &symbolic.fronts[front]);
        let tops =
            top.map(|front| (range(front.first, front), range(symbolic.top_index(front.first), front)));
        for solver in &*solvers {
            for (all, own) in tops.clone() {
                for (sum, value) in permuted[all].iter_mut().zip(&solver.top[own]) {
                    *sum += value;
                }
            }
        }
        for direction in [Direction::Forward, Direction::Backward] {
            let places = Places { symbolic, first: 0, own: permuted, top: &mut [] };
            for_small_blocks(Substitute::<D, S> { fronts: &symbolic.top, direction, panels, places, local });
        }
        for solver in solvers.iter_mut() {
            for (all, own) in tops.clone() {
                solver.top[own].copy_from_slice(&permuted[all]);
            }
        }
        by_subtrees::<D, S>(symbolic, panels, permuted, solvers, Direction::Backward);
        for (value, &variable) in self.permuted.chunks_exact(D).zip(&symbolic.order) {
            values[variable].as_mut_slice().copy_from_slice(value);
        }
    }
}

/// One of the triangular solves in all subtrees.
fn by_subtrees<const D: usize, S: Stored>(
    symbolic: &Symbolic,
    panels: &[S],
    values: &mut [f64],
    solvers: &mut [Solver],
    direction: Direction,
) {
    if solvers.is_empty() {
        // The thread pool is not entered for nothing.
        return;
    }
    let mut values = Rest::new(values);
    let tasks: Vec<_> = symbolic
        .subtrees
        .iter()
        .zip(solvers)
        .map(|(subtree, Solver { top, local })| {
            let first = subtree.positions.start;
            let own = values.cut(first * D..subtree.positions.end * D);
            let places = Places { symbolic, first, own, top };
            Substitute::<D, S> { fronts: &subtree.fronts, direction, panels, places, local }
        })
        .collect();
    tasks.into_par_iter().for_each(for_small_blocks);
}

/// The first or the second triangular solve.
#[derive(Clone, Copy)]
enum Direction {
    Forward,
    Backward,
}

/// A triangular solve of some fronts for one set of vector instructions. Not a closure: a closure would not be inlined.
struct Substitute<'a, const D: usize, S> {
    /// Children before parents.
    fronts: &'a [usize],
    direction: Direction,
    panels: &'a [S],
    places: Places<'a>,
    local: &'a mut [f64],
}

impl<const D: usize, N: Stored> WithSimd for Substitute<'_, D, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { fronts, direction, panels, mut places, local } = self;
        let symbolic = places.symbolic;
        match direction {
            Direction::Forward => {
                for &front in fronts {
                    forward::<D, N>(&symbolic.fronts[front], panels, &mut places, local);
                }
            }
            Direction::Backward => {
                for &front in fronts.iter().rev() {
                    backward::<D, N>(&symbolic.fronts[front], panels, &mut places, local);
                }
            }
        }
    }
}

/// The values that fronts read and write: a vector's part from the variable at `first` on, and those of the tree's top where
/// that part does not reach it.
pub(crate) struct Places<'a> {
    pub(crate) symbolic: &'a Symbolic,
    pub(crate) first: usize,
    pub(crate) own: &'a mut [f64],
    pub(crate) top: &'a mut [f64],
}

impl Places<'_> {
    /// The same with a shorter lifetime. Passed by value, so that its fields stay in registers in loops.
    #[inline(always)]
    fn reborrow(&mut self) -> Places<'_> {
        let Self { symbolic, first, own, top } = self;
        Places { symbolic, first: *first, own, top }
    }

    /// The values of a front's own variables.
    #[inline(always)]
    fn of<const D: usize>(&mut self, front: &Front) -> &mut [f64] {
        &mut self.own[(front.first - self.first) * D..][..front.columns * D]
    }

    /// Calls `visit` with every row below a front's columns in `local` and its values.
    #[inline(always)]
    fn below<const D: usize>(self, front: &Front, local: &mut [f64], visit: impl Fn(&mut [f64], &mut [f64])) {
        let Self { symbolic, first, own, top } = self;
        let rows = &symbolic.rows[front.rows.clone()];
        for (&row, local) in rows.iter().zip(local.chunks_exact_mut(D)) {
            let start = (row - first) * D;
            if start < own.len() {
                visit(local, &mut own[start..start + D]);
            } else {
                visit(local, &mut top[symbolic.top_index(row) * D..][..D]);
            }
        }
    }
}

/// The columns of a front, and working memory for all its rows with the front's own values in it.
#[inline(always)]
fn open<'a, const D: usize, S: Stored>(
    front: &Front,
    panels: &'a [S],
    places: &mut Places<'_>,
    local: &'a mut [f64],
) -> (&'a [S], &'a mut [f64]) {
    let height = front.height() * D;
    let columns = front.columns * D;
    let local = &mut local[..height];
    copy_blocks::<D>(&mut local[..columns], places.of::<D>(front));
    (&panels[front.panel * D * D..][..columns * height], local)
}

/// Copies values block by block: most fronts have few columns, and a call of the system's routine would take longer than the copy.
#[inline(always)]
fn copy_blocks<const D: usize>(to: &mut [f64], from: &[f64]) {
    let (to, from) = (to.as_chunks_mut::<D>().0, from.as_chunks::<D>().0);
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// The reciprocals of a block's pivots. They do not wait for the values that are solved for, as quotients would.
#[inline(always)]
fn reciprocals<const D: usize, S: Stored>(block: &[S], height: usize, start: usize) -> [f64; D] {
    std::array::from_fn(|column| 1.0 / block[column * height + start + column].widened())
}

/// `x_1 = L^-1 x_1`, then `x_2 -= M x_1`, for the columns of one front. `local` is working memory.
#[inline(always)]
pub(crate) fn forward<const D: usize, S: Stored>(
    front: &Front,
    panels: &[S],
    places: &mut Places<'_>,
    local: &mut [f64],
) {
    let (panel, local) = open::<D, S>(front, panels, places, local);
    let (height, columns) = (local.len(), front.columns * D);
    local[columns..].fill(0.0);
    for (block_index, block) in panel.chunks_exact(D * height).enumerate() {
        let start = block_index * D;
        let mut solved = [0.0; D];
        let reciprocals = reciprocals::<D, S>(block, height, start);
        for column in 0..D {
            let values = &block[column * height + start..][..D];
            let value = local[start + column] * reciprocals[column];
            solved[column] = value;
            local[start + column] = value;
            for row in column + 1..D {
                local[start + row] -= value * values[row].widened();
            }
        }
        let target = &mut local[start + D..];
        let sources: [&[S]; D] =
            std::array::from_fn(|column| &block[column * height + start + D..][..target.len()]);
        subtract_columns(target, &sources, &solved);
    }
    copy_blocks::<D>(places.of::<D>(front), &local[..columns]);
    places.reborrow().below::<D>(front, &mut local[columns..], |values, targets| {
        for (target, value) in targets.iter_mut().zip(values) {
            *target += *value;
        }
    });
}

/// `x_1 = L^-T (x_1 - M^T x_2)` for the columns of one front. `local` is working memory.
#[inline(always)]
pub(crate) fn backward<const D: usize, S: Stored>(
    front: &Front,
    panels: &[S],
    places: &mut Places<'_>,
    local: &mut [f64],
) {
    let (panel, local) = open::<D, S>(front, panels, places, local);
    let (height, columns) = (local.len(), front.columns * D);
    places.reborrow().below::<D>(front, &mut local[columns..], |values, known| values.copy_from_slice(known));
    for (block_index, block) in panel.chunks_exact(D * height).enumerate().rev() {
        let start = block_index * D;
        let known = &local[start + D..];
        let sources: [&[S]; D] =
            std::array::from_fn(|column| &block[column * height + start + D..][..known.len()]);
        // Partial sums hide the latency of an addition; the more columns there are, the fewer each needs.
        let sums =
            if D < 4 { products::<D, 8, S>(&sources, known) } else { products::<D, 4, S>(&sources, known) };
        let reciprocals = reciprocals::<D, S>(block, height, start);
        for column in (0..D).rev() {
            let values = &block[column * height + start..][..D];
            let mut sum = local[start + column] - sums[column];
            for row in column + 1..D {
                sum -= values[row].widened() * local[start + row];
            }
            local[start + column] = sum * reciprocals[column];
        }
    }
    copy_blocks::<D>(places.of::<D>(front), &local[..columns]);
}

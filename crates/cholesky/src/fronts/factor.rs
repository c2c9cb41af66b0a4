//! The numeric phase: multifrontal factorisation and triangular solves.

use std::marker::PhantomData;

use nalgebra::SMatrix;

use super::breakdown::Breakdown;
use super::stored::Stored;
use super::substitution::Solver;
use super::task::{SmallestPivot, Task, Worker, side_by_side};
use super::workspaces::Workspaces;
use crate::instructions::for_small_blocks;
use crate::matrix::Matrix;
use crate::selected_inverse::SelectedInverse;
use crate::symbolic::{Front, Symbolic};

/// A pivot below this share of its diagonal entry is rounding error: some fifty units in the last place of the entry, which
/// is the error of sums of that many terms.
pub const SINGULAR: f64 = 1e-14;

/// Memory and values of a factor with blocks of order `D`, stored in numbers `S`: `P A P^T = L L^T`.
pub struct Factor<const D: usize, S = f64> {
    /// The factor: memory of numbers `S`, which every kind of factor can use.
    pub(crate) panels: Vec<f64>,
    stored: PhantomData<S>,
    /// Update matrices on their way to the parents; of no use after the factorisation.
    pub(crate) stacks: [Vec<f64>; 2],
    /// Memory for a selected inverse.
    pub(crate) inverse: Vec<f64>,
    /// One worker for each stretch of fronts.
    workers: Vec<Worker>,
    pub(crate) permuted: Vec<f64>,
    /// A front's rows of a vector.
    pub(crate) local: Vec<f64>,
    /// One for each subtree.
    pub(super) solvers: Vec<Solver>,
    smallest_pivot: SmallestPivot,
}

/// The large memory of a [`Factor`] and its [`SelectedInverse`], without values, for the next factor.
///
/// New memory from the operating system comes page by page, on first use. For a program that factorises matrix after matrix
/// of some 10^4 variables, that takes a tenth of its time.
#[derive(Debug, Default)]
pub struct Memory {
    panels: Vec<f64>,
    stacks: [Vec<f64>; 2],
    inverse: Vec<f64>,
}

/// Old values may remain: the numeric phase writes before it reads.
pub(crate) fn resized(mut memory: Vec<f64>, length: usize) -> Vec<f64> {
    if memory.capacity() < length {
        // Pages that the system has zeroed, and that nothing touches before the numeric phase.
        return vec![0.0; length];
    }
    memory.resize(length, 0.0);
    memory
}

impl<const D: usize, S> std::fmt::Debug for Factor<D, S> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Factor").field("scalars", &self.panels.len()).finish_non_exhaustive()
    }
}

impl<const D: usize> Factor<D> {
    /// Reserves all memory that factorising and solving with this pattern need.
    pub fn new(symbolic: &Symbolic) -> Self {
        Self::with_memory(symbolic, Memory::default())
    }
}

impl<const D: usize, S: Stored> Factor<D, S> {
    /// How many `f64` take the memory of this many blocks.
    fn panel_memory(blocks: usize) -> usize {
        (blocks * D * D * size_of::<S>()).div_ceil(size_of::<f64>())
    }

    /// Lends the memory to a factor in double precision with the same pattern and blocks that take no more. The values of this factor are
    /// lost.
    pub fn lend<const E: usize, T>(&mut self, work: impl FnOnce(&mut Factor<E>) -> T) -> T {
        debug_assert!(
            E * E * size_of::<f64>() <= D * D * size_of::<S>(),
            "memory for blocks that take no more is lent"
        );
        let mut other = Factor::<E>::empty();
        self.exchange(&mut other);
        let result = work(&mut other);
        self.exchange(&mut other);
        result
    }

    fn exchange<const E: usize>(&mut self, other: &mut Factor<E>) {
        std::mem::swap(&mut self.panels, &mut other.panels);
        std::mem::swap(&mut self.stacks, &mut other.stacks);
        std::mem::swap(&mut self.workers, &mut other.workers);
        std::mem::swap(&mut self.permuted, &mut other.permuted);
        std::mem::swap(&mut self.local, &mut other.local);
        std::mem::swap(&mut self.solvers, &mut other.solvers);
    }

    /// The memory of this factor, and of an inverse computed from it.
    pub fn into_memory(self, inverse: Option<SelectedInverse<D>>) -> Memory {
        let inverse = inverse.map_or(self.inverse, |inverse| inverse.panels);
        Memory { panels: self.panels, stacks: self.stacks, inverse }
    }

    /// Reserves all memory that factorising and solving with this pattern need, from that of another factor, of any pattern. No value
    /// of that factor matters.
    pub fn with_memory(symbolic: &Symbolic, memory: Memory) -> Self {
        let Memory { panels, stacks: [even, odd], inverse } = memory;
        let height = symbolic.fronts.iter().map(Front::height).max().unwrap_or(0);
        let [even_blocks, odd_blocks] = symbolic.stack_blocks;
        Self {
            panels: resized(panels, Self::panel_memory(symbolic.panel_blocks)),
            stored: PhantomData,
            stacks: [resized(even, even_blocks * D * D), resized(odd, odd_blocks * D * D)],
            inverse,
            workers: symbolic.stretches.iter().map(|stretch| Worker::new::<D>(symbolic, stretch)).collect(),
            permuted: vec![0.0; symbolic.variables() * D],
            local: vec![0.0; height * D],
            solvers: symbolic.subtrees.iter().map(|subtree| Solver::new::<D>(symbolic, subtree)).collect(),
            smallest_pivot: SmallestPivot::default(),
        }
    }

    /// A factor of no matrix.
    fn empty() -> Self {
        Self {
            panels: Vec::new(),
            stored: PhantomData,
            stacks: [Vec::new(), Vec::new()],
            inverse: Vec::new(),
            workers: Vec::new(),
            permuted: Vec::new(),
            local: Vec::new(),
            solvers: Vec::new(),
            smallest_pivot: SmallestPivot::default(),
        }
    }

    /// Factorises the matrix with these diagonal blocks and off-diagonal blocks (row: first of its pair).
    ///
    /// `damping` is the multiple of the diagonal that is added, after each diagonal entry was raised to at least the `floor`
    /// of its component: `A + damping * max(diag A, floor)`.
    pub fn factorize(
        &mut self,
        symbolic: &Symbolic,
        diagonal: &[SMatrix<f64, D, D>],
        off_diagonal: &[SMatrix<f64, D, D>],
        damping: f64,
        floor: [f64; D],
    ) -> Result<(), Breakdown> {
        self.factorize_matrix(symbolic, Matrix { diagonal, off_diagonal, damping, floor })
    }

    /// The same with the parts of the matrix in one.
    pub(crate) fn factorize_matrix(
        &mut self,
        symbolic: &Symbolic,
        matrix: Matrix<'_, D>,
    ) -> Result<(), Breakdown> {
        let Self { panels, stacks, workers, smallest_pivot, .. } = self;
        let panels: &mut [S] = bytemuck::cast_slice_mut(panels);
        *smallest_pivot = SmallestPivot::default();
        let Some((rest, others)) = symbolic.stretches.split_last() else { return Ok(()) };
        let failed = if others.is_empty() {
            None
        } else {
            // Enters the thread pool once for all of the following.
            rayon::scope(|_| side_by_side(symbolic, others, matrix, panels, stacks, workers)).err()
        };
        // After a failure only fronts before the failed one matter. A single thread might have met a failure there first, and
        // the variable in the error must not depend on the number of threads.
        let end = failed
            .as_ref()
            .map_or(usize::MAX, |failed| symbolic.front_of[symbolic.position[failed.variable]]);
        let fronts = &rest.fronts[..rest.fronts.partition_point(|&front| front < end)];
        if let Some(worker) = workers.last_mut() {
            let [even, odd] = stacks;
            let stacks = [even.as_mut_slice(), odd.as_mut_slice()];
            let task = Task {
                symbolic,
                matrix,
                fronts,
                panels,
                panel_base: 0,
                stacks,
                stack_bases: [0; 2],
                worker,
                workspaces: &Workspaces::of::<D, S>(symbolic, std::slice::from_ref(rest)),
            };
            for_small_blocks(task)?;
        }
        if let Some(failed) = failed {
            return Err(failed);
        }
        for worker in workers {
            smallest_pivot.note(worker.smallest_pivot);
        }
        Ok(())
    }

    /// The smallest share `L_kk^2 / A_kk` of a diagonal entry that remains after elimination, with its variable and
    /// component.
    ///
    /// If it is near the unit round-off, the matrix is singular to working precision.
    pub fn smallest_pivot(&self) -> (f64, usize, usize) {
        let SmallestPivot { share, variable, component } = self.smallest_pivot;
        (share, variable, component)
    }

    /// Variable and component of a direction that is undetermined to working precision: the remaining share of the diagonal
    /// entry is at most [`SINGULAR`] or is not a number.
    pub fn undetermined(&self) -> Option<(usize, usize)> {
        let SmallestPivot { share, variable, component } = self.smallest_pivot;
        (share.is_nan() || share <= SINGULAR).then_some((variable, component))
    }
}

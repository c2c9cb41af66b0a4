//! A factor that is stored in single precision, with solutions that its rounding does not limit.
//!
//! Elimination computes in double precision, so pivots are as exact as ever; only the factor that it leaves is rounded, to half the
//! memory. Conjugate gradients on the matrix itself, with this factor as the preconditioner, then solve in one or two iterations. (Elimination
//! in single precision would hardly be faster, and its errors swamp the soft directions of long chains: there conjugate
//! gradients took ten iterations and more.)

use nalgebra::SVector;

use crate::fronts::breakdown::Breakdown;
use crate::fronts::factor::{Factor, Memory};
use crate::fronts::stored::Stored;
use crate::matrix::Matrix;
use crate::symbolic::Symbolic;
use crate::vectors::{add, dot};

/// From this many bytes in double precision on, a factor is stored in single precision. Below, memory is no concern, and one triangular
/// solve is faster than the two or three of a solution by conjugate gradients.
const LARGE: u64 = 4 << 30;

/// The iteration ends when the residual's square, in the norm of the preconditioner, is below this share of the solution's: a
/// ten-thousandth of a Gauss-Newton step is far below what its linear model knows.
const REDUCTION: f64 = 1e-8;

/// Iterations after which a factor in double precision takes over. A new factor costs as much as ten or more iterations.
const ITERATIONS: usize = 20;

/// A factor in double precision or, if that would take four gibibytes or more, one stored in single precision.
#[derive(Debug)]
pub enum MixedFactor<const D: usize> {
    /// In double precision.
    Double(Factor<D>),
    /// Stored in single precision. With the first matrix that needs it, it changes to double precision for good.
    Single(Factor<D, f32>),
}

impl<const D: usize> MixedFactor<D> {
    /// Reserves all memory for this pattern, from that of another factor.
    pub fn with_memory(symbolic: &Symbolic, memory: Memory) -> Self {
        if (symbolic.factor_blocks() * D * D) as u64 * 8 >= LARGE {
            return Self::Single(Factor::with_memory(symbolic, memory));
        }
        Self::Double(Factor::with_memory(symbolic, memory))
    }

    /// A factor stored in single precision, however small it is.
    pub fn single(symbolic: &Symbolic) -> Self {
        Self::Single(Factor::with_memory(symbolic, Memory::default()))
    }

    /// Whether the factor is stored in single precision.
    pub fn is_single(&self) -> bool {
        matches!(self, Self::Single(_))
    }

    /// The memory of the factor.
    pub fn into_memory(self) -> Memory {
        match self {
            Self::Double(factor) => factor.into_memory(None),
            Self::Single(factor) => factor.into_memory(None),
        }
    }

    /// As [`Factor::lend`].
    pub fn lend<const E: usize, R>(&mut self, work: impl FnOnce(&mut Factor<E>) -> R) -> R {
        match self {
            Self::Double(factor) => factor.lend(work),
            Self::Single(factor) => factor.lend(work),
        }
    }

    /// As [`Factor::factorize`].
    pub fn factorize(&mut self, symbolic: &Symbolic, matrix: Matrix<'_, D>) -> Result<(), Breakdown> {
        match self {
            Self::Double(factor) => factor.factorize_matrix(symbolic, matrix),
            Self::Single(factor) => factor.factorize_matrix(symbolic, matrix),
        }
    }

    /// As [`Factor::undetermined`].
    pub fn undetermined(&self) -> Option<(usize, usize)> {
        match self {
            Self::Double(factor) => factor.undetermined(),
            Self::Single(factor) => factor.undetermined(),
        }
    }

    /// Solves approximately, as a preconditioner does: as exactly as the stored numbers are.
    pub fn precondition(&mut self, symbolic: &Symbolic, values: &mut [SVector<f64, D>]) {
        match self {
            Self::Double(factor) => factor.solve(symbolic, values),
            Self::Single(factor) => factor.solve(symbolic, values),
        }
    }

    /// Solves `A x = b` for the matrix that was factorised last; `values` holds `b` and becomes `x`. `pairs` are those of its off-diagonal
    /// blocks. With a factor in single precision, the error is about a ten-thousandth of the solution in the norm of `A`.
    ///
    /// If conjugate gradients fail, as with numbers outside the range of single precision, the matrix is factorised in double precision,
    /// which can break down where it did not before only by a different rounding.
    pub fn solve(
        &mut self,
        symbolic: &Symbolic,
        pairs: &[(usize, usize)],
        matrix: Matrix<'_, D>,
        values: &mut [SVector<f64, D>],
    ) -> Result<(), Breakdown> {
        if self.is_single() {
            let end = End { iterations: ITERATIONS, left: REDUCTION, enough: 0.0 };
            if self.iterate(symbolic, pairs, matrix, values, end).is_some() {
                return Ok(());
            }
            *self = Self::Double(Factor::new(symbolic));
            self.factorize(symbolic, matrix)?;
        }
        self.precondition(symbolic, values);
        Ok(())
    }

    /// Solves `A x = b` approximately for another matrix with the same pattern, by conjugate gradients with this factor as the
    /// preconditioner; `values` holds `b` and becomes `x`.
    ///
    /// Returns the residual's square in the norm of the preconditioner, an estimate of how much `b^T x` would still grow, or `None`, with
    /// `values` as they were, if more iterations than allowed would be needed.
    pub fn iterate(
        &mut self,
        symbolic: &Symbolic,
        pairs: &[(usize, usize)],
        matrix: Matrix<'_, D>,
        values: &mut [SVector<f64, D>],
        end: End,
    ) -> Option<f64> {
        let iteration = Iteration { symbolic, pairs, matrix, end };
        match self {
            Self::Double(factor) => iteration.solve(factor, values),
            Self::Single(factor) => iteration.solve(factor, values),
        }
    }
}

/// When conjugate gradients end. `b^T x` grows from iteration to iteration; for the normal equations of a step it is the decrease of the
/// cost that their model promises.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// The most iterations.
    pub iterations: usize,
    /// The share of `b^T x` that the residual's square in the norm of the preconditioner may be.
    pub left: f64,
    /// The value that `b^T x` and this square together need not reach.
    pub enough: f64,
}

impl End {
    fn is_reached(&self, decrease: f64, square: f64) -> bool {
        square <= self.left * decrease || (decrease > 0.0 && decrease + square <= self.enough)
    }
}

/// Conjugate gradients on a matrix with a factor of it, or of one like it, as the preconditioner.
struct Iteration<'a, const D: usize> {
    symbolic: &'a Symbolic,
    pairs: &'a [(usize, usize)],
    matrix: Matrix<'a, D>,
    end: End,
}

impl<const D: usize> Iteration<'_, D> {
    /// As [`MixedFactor::iterate`].
    fn solve<S: Stored>(&self, factor: &mut Factor<D, S>, values: &mut [SVector<f64, D>]) -> Option<f64> {
        let Self { symbolic, pairs, matrix, end } = *self;
        let mut residual = values.to_vec();
        let mut direction = residual.clone();
        factor.solve(symbolic, &mut direction);
        let mut square = dot(&residual, &direction);
        let mut solution = vec![SVector::zeros(); values.len()];
        let mut decrease = 0.0;
        let (mut preconditioned, mut product) = (Vec::new(), Vec::new());
        for _ in 0..end.iterations {
            if end.is_reached(decrease, square) {
                break;
            }
            matrix.multiply(pairs, &direction, &mut product);
            let length = square / dot(&direction, &product);
            if !(length > 0.0 && length.is_finite()) {
                return None;
            }
            decrease += length * square;
            add(&mut solution, length, &direction);
            add(&mut residual, -length, &product);
            preconditioned.clone_from(&residual);
            factor.solve(symbolic, &mut preconditioned);
            let next = dot(&residual, &preconditioned);
            let share = next / square;
            for (direction, preconditioned) in direction.iter_mut().zip(&preconditioned) {
                *direction = preconditioned + *direction * share;
            }
            square = next;
        }
        if !end.is_reached(decrease, square) {
            return None;
        }
        values.copy_from_slice(&solution);
        Some(square)
    }
}

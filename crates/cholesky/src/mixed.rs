//! A factor that is stored in single precision, with solutions as exact as those of one in double precision.
//!
//! Elimination computes in double precision, so pivots are as exact as ever; only the factor that it leaves is rounded, to half the
//! memory. Conjugate gradients on the matrix itself, with this factor as the preconditioner, then solve in two or three iterations. (Elimination
//! in single precision would hardly be faster, and its errors swamp the soft directions of long chains: there conjugate
//! gradients took ten iterations and more.)

use nalgebra::SVector;

use crate::fronts::breakdown::Breakdown;
use crate::fronts::factor::{Factor, Memory};
use crate::matrix::Matrix;
use crate::symbolic::Symbolic;

/// From this many bytes in double precision on, a factor is stored in single precision. Below, memory is no concern, and one triangular
/// solve is faster than the two or three that a solution takes otherwise.
const LARGE: u64 = 4 << 30;

/// The iteration ends when the residual's square, in the norm of the preconditioner, is below this share of the right-hand side's: a
/// ten-thousandth of a Gauss-Newton step is far below what its linear model knows.
const REDUCTION: f64 = 1e-8;

/// Iterations after which a factor in double precision takes over. A new factor costs as much as ten or more iterations.
const ITERATIONS: usize = 20;

/// A factor in double precision or, if that would take four gibibytes or more, one stored in single precision.
#[derive(Debug)]
pub struct MixedFactor<const D: usize> {
    double: Factor<D>,
    /// The factor in use, if any; `double` is empty then.
    single: Option<Factor<D, f32>>,
}

impl<const D: usize> MixedFactor<D> {
    /// Reserves all memory for this pattern, from that of another factor.
    pub fn with_memory(symbolic: &Symbolic, memory: Memory) -> Self {
        if (symbolic.factor_blocks() * D * D) as u64 * 8 >= LARGE {
            return Self::single(symbolic);
        }
        Self { double: Factor::with_memory(symbolic, memory), single: None }
    }

    /// A factor stored in single precision, however small it is.
    pub fn single(symbolic: &Symbolic) -> Self {
        Self { double: Factor::empty(), single: Some(Factor::single(symbolic)) }
    }

    /// Whether the factor is stored in single precision. With the first matrix that needs it, it changes to double precision for good.
    pub fn is_single(&self) -> bool {
        self.single.is_some()
    }

    /// The memory of a factor in double precision; one in single precision has none to hand on.
    pub fn into_memory(self) -> Memory {
        self.double.into_memory(None)
    }

    /// As [`Factor::lend`]; a factor in single precision lends no memory.
    pub fn lend<const E: usize, R>(
        &mut self,
        symbolic: &Symbolic,
        work: impl FnOnce(&mut Factor<E>) -> R,
    ) -> R {
        if self.is_single() { work(&mut Factor::new(symbolic)) } else { self.double.lend(work) }
    }

    /// As [`Factor::factorize`].
    pub fn factorize(&mut self, symbolic: &Symbolic, matrix: Matrix<'_, D>) -> Result<(), Breakdown> {
        let Matrix { diagonal, off_diagonal, damping, floor } = matrix;
        match &mut self.single {
            Some(single) => single.factorize(symbolic, diagonal, off_diagonal, damping, floor),
            None => self.double.factorize(symbolic, diagonal, off_diagonal, damping, floor),
        }
    }

    /// As [`Factor::undetermined`].
    pub fn undetermined(&self) -> Option<(usize, usize)> {
        self.single.as_ref().map_or_else(|| self.double.undetermined(), Factor::undetermined)
    }

    /// Solves approximately, as a preconditioner does: as exactly as the stored numbers are.
    pub fn precondition(&mut self, symbolic: &Symbolic, values: &mut [SVector<f64, D>]) {
        match &mut self.single {
            Some(single) => single.solve(symbolic, values),
            None => self.double.solve(symbolic, values),
        }
    }

    /// Solves `A x = b` for the matrix that was factorised last; `values` holds `b` and becomes `x`.
    ///
    /// If conjugate gradients fail, as with numbers outside the range of single precision, the matrix is factorised in double precision,
    /// which can break down where it did not before only by a different rounding.
    pub fn solve(
        &mut self,
        symbolic: &Symbolic,
        matrix: Matrix<'_, D>,
        values: &mut [SVector<f64, D>],
    ) -> Result<(), Breakdown> {
        if let Some(single) = &mut self.single {
            if conjugate_gradients(single, symbolic, matrix, values) {
                return Ok(());
            }
            self.single = None;
            self.double = Factor::new(symbolic);
            self.factorize(symbolic, matrix)?;
        }
        self.double.solve(symbolic, values);
        Ok(())
    }
}

/// Solves `A x = b`; `values` holds `b` and becomes `x`. Returns false, and leaves `values` as it is, if that takes too many iterations.
fn conjugate_gradients<const D: usize>(
    factor: &mut Factor<D, f32>,
    symbolic: &Symbolic,
    matrix: Matrix<'_, D>,
    values: &mut [SVector<f64, D>],
) -> bool {
    let mut residual = values.to_vec();
    let mut direction = residual.clone();
    factor.solve(symbolic, &mut direction);
    let mut square = dot(&residual, &direction);
    let mut solution = vec![SVector::zeros(); values.len()];
    let enough = REDUCTION * square;
    let mut product = solution.clone();
    let mut preconditioned = Vec::new();
    for _ in 0..ITERATIONS {
        if square <= enough {
            values.copy_from_slice(&solution);
            return true;
        }
        matrix.multiply(symbolic, &direction, &mut product);
        let length = square / dot(&direction, &product);
        if !(length > 0.0 && length.is_finite()) {
            return false;
        }
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
    false
}

fn dot<const D: usize>(a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn add<const D: usize>(to: &mut [SVector<f64, D>], factor: f64, what: &[SVector<f64, D>]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += what * factor);
}

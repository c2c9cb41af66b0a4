//! The quadratic form `tr(U M U^T)` on the tangents at a point, and its factor.
//!
//! Without the multipliers, it is the Hessian there: positive semidefinite, and all of it near a minimum of small cost. `M` itself, on blocks that
//! need not be tangents, is a poor stand-in: it also lets axes grow and shrink, and where information spans many orders of magnitude that is
//! how it would mend every error.

use nalgebra::{SMatrix, SVector};
use posecut_cholesky::{Factor, Memory, Symbolic};

use super::manifold::Lift;
use crate::certificate::chordal_matrix::ChordalMatrix;
use crate::effort::Effort;

/// Shares of the largest entry of `M` that are added to turns before the factorisation, the next one where it fails: a common turn of all
/// poses costs nothing.
const SHIFTS: [f64; 4] = [1e-12, 1e-9, 1e-6, 1e-3];

/// An orthonormal basis of the tangents at a block: `P` translations, the turns within the space that the axes span, and those out of it.
type Basis<const P: usize, const M: usize, const T: usize> = [SMatrix<f64, P, M>; T];

/// The bases of all blocks of a point, `T` tangents each, and the form's factor.
pub(super) struct Tangents<const P: usize, const M: usize, const T: usize> {
    symbolic: Symbolic,
    factor: Factor<T, f32>,
    bases: Vec<Basis<P, M, T>>,
}

impl<const P: usize, const M: usize, const T: usize> Tangents<P, M, T> {
    pub(super) fn new(matrix: &ChordalMatrix<M>) -> Self {
        let symbolic = Symbolic::new(matrix.diagonal.len(), &matrix.pairs, T);
        let factor = Factor::with_memory(&symbolic, Memory::default());
        Self { symbolic, factor, bases: Vec::new() }
    }

    /// Factorises at the point; returns whether that succeeds.
    pub(super) fn move_to(&mut self, matrix: &ChordalMatrix<M>, x: &Lift<P, M>, effort: &mut Effort) -> bool {
        self.bases = x.iter().map(basis).collect();
        let reduced = |a: usize, block: &SMatrix<f64, M, M>, b: usize| {
            let left = self.bases[a].map(|element| element * block);
            SMatrix::<f64, T, T>::from_fn(|row, column| left[row].dot(&self.bases[b][column]))
        };
        let diagonal: Vec<_> =
            matrix.diagonal.iter().enumerate().map(|(node, block)| reduced(node, block, node)).collect();
        let pairs = matrix.pairs.iter().zip(&matrix.off_diagonal);
        let off_diagonal: Vec<_> = pairs.map(|(&(a, b), block)| reduced(a, block, b)).collect();
        SHIFTS.iter().any(|share| {
            effort.compute(self.symbolic.flops());
            let shift = share * matrix.largest();
            let mut shifted = diagonal.clone();
            for block in &mut shifted {
                for axis in P..T {
                    block[(axis, axis)] += shift;
                }
            }
            self.factor.factorize(&self.symbolic, &shifted, &off_diagonal, 0.0, [0.0; T]).is_ok()
        })
    }

    /// The tangent whose form with any tangent `V` is `tr(R V^T)`.
    pub(super) fn divide(&mut self, r: &Lift<P, M>, effort: &mut Effort) -> Lift<P, M> {
        effort.substitute(1, T * T * size_of::<f32>() * self.symbolic.factor_blocks());
        let shares = |(r, basis): (&SMatrix<f64, P, M>, &Basis<P, M, T>)| {
            SVector::from_fn(|axis, _| r.dot(&basis[axis]))
        };
        let mut reduced: Vec<SVector<f64, T>> = r.iter().zip(&self.bases).map(shares).collect();
        reduced[0].rows_mut(0, P).fill(0.0);
        self.factor.solve(&self.symbolic, &mut reduced);
        let sum = |(shares, basis): (&SVector<f64, T>, &Basis<P, M, T>)| {
            basis.iter().zip(shares).fold(SMatrix::zeros(), |sum, (element, share)| sum + element * *share)
        };
        reduced.iter().zip(&self.bases).map(sum).collect()
    }
}

fn basis<const P: usize, const M: usize, const T: usize>(x: &SMatrix<f64, P, M>) -> Basis<P, M, T> {
    let mut all = [SMatrix::<f64, P, M>::zeros(); T];
    let mut elements = all.iter_mut();
    for (row, element) in (0..P).zip(&mut elements) {
        element[(row, 0)] = 1.0;
    }
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (one, other) in (1..M).flat_map(|one| (one + 1..M).map(move |other| (one, other))) {
        let Some(element) = elements.next() else { break };
        element.set_column(other, &(x.column(one) * half));
        element.set_column(one, &(x.column(other) * -half));
    }
    let mut spanned: Vec<SVector<f64, P>> = (1..M).map(|axis| x.column(axis).into_owned()).collect();
    while spanned.len() < P {
        let outside = furthest(&spanned);
        for (axis, element) in (1..M).zip(&mut elements) {
            element.set_column(axis, &outside);
        }
        spanned.push(outside);
    }
    all
}

/// A unit vector at right angles to orthonormal vectors: the part outside their span of the unit vector that has most of it there.
fn furthest<const P: usize>(spanned: &[SVector<f64, P>]) -> SVector<f64, P> {
    let outside = |row: usize| {
        let mut rest = SVector::<f64, P>::zeros();
        rest[row] = 1.0;
        for known in spanned {
            rest -= known * known.dot(&rest);
        }
        rest
    };
    let longer = |one: SVector<f64, P>, other: SVector<f64, P>| {
        if other.norm_squared() > one.norm_squared() { other } else { one }
    };
    (1..P).map(outside).fold(outside(0), longer).normalize()
}

#[cfg(test)]
mod tests {
    use super::super::manifold::orthonormalise;
    use super::*;

    /// Checks that the basis is orthonormal and its elements are tangents: the symmetric part of `Y^T U` is zero.
    fn check<const P: usize, const M: usize, const T: usize>() {
        for seed in 0..20 {
            let block = SMatrix::<f64, P, M>::from_fn(|row, column| {
                (f64::from(seed) + ((row * M + column) as f64).powi(2) * 1.7).sin()
            });
            let x = orthonormalise(block);
            let basis: Basis<P, M, T> = basis(&x);
            let gram = SMatrix::<f64, T, T>::from_fn(|row, column| basis[row].dot(&basis[column]));
            assert!((gram - SMatrix::identity()).amax() < 1e-12, "{gram}");
            for element in basis {
                let inner = SMatrix::<f64, M, M>::from_fn(|row, column| {
                    if row == 0 || column == 0 { 0.0 } else { x.column(row).dot(&element.column(column)) }
                });
                assert!((inner + inner.transpose()).amax() < 1e-12, "{inner}");
            }
        }
    }

    #[test]
    fn bases_are_orthonormal_tangents() {
        check::<4, 3, 9>();
        check::<5, 4, 14>();
    }
}

//! A matrix to factorise, and its product with a vector.

use nalgebra::{SMatrix, SVector};

use crate::symbolic::Symbolic;

/// A symmetric matrix of blocks of order `D`, with damping: `A + damping * max(diag A, floor)`.
#[derive(Clone, Copy, Debug)]
pub struct Matrix<'a, const D: usize> {
    /// Diagonal blocks, one for each variable.
    pub diagonal: &'a [SMatrix<f64, D, D>],
    /// Off-diagonal blocks, one for each pair; row: first of the pair.
    pub off_diagonal: &'a [SMatrix<f64, D, D>],
    /// The multiple of the diagonal that is added.
    pub damping: f64,
    /// The least value of the diagonal entries that `damping` multiplies, by component.
    pub floor: [f64; D],
}

impl<const D: usize> Matrix<'_, D> {
    /// `product = A vector`.
    pub(crate) fn multiply(
        &self,
        symbolic: &Symbolic,
        vector: &[SVector<f64, D>],
        product: &mut [SVector<f64, D>],
    ) {
        for ((product, block), value) in product.iter_mut().zip(self.diagonal).zip(vector) {
            *product = block * value;
            for component in 0..D {
                let entry = block[(component, component)].max(self.floor[component]);
                product[component] += self.damping * entry * value[component];
            }
        }
        for (pair, row, column) in symbolic.blocks() {
            let block = &self.off_diagonal[pair];
            product[row] += block * vector[column];
            product[column] += block.tr_mul(&vector[row]);
        }
    }
}

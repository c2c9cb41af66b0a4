//! A matrix to factorise, and its product with a vector.

use nalgebra::{SMatrix, SVector};

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
    /// The product with a vector. `pairs` are those of the off-diagonal blocks.
    pub fn times(&self, pairs: &[(usize, usize)], vector: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let mut product = Vec::new();
        self.multiply(pairs, vector, &mut product);
        product
    }

    /// The same into memory of an earlier product.
    pub(crate) fn multiply(
        &self,
        pairs: &[(usize, usize)],
        vector: &[SVector<f64, D>],
        product: &mut Vec<SVector<f64, D>>,
    ) {
        let Self { diagonal, off_diagonal, damping, floor } = *self;
        product.clear();
        product.extend(diagonal.iter().zip(vector).map(|(block, value)| block * value));
        if damping != 0.0 {
            for ((product, block), value) in product.iter_mut().zip(diagonal).zip(vector) {
                for component in 0..D {
                    let entry = block[(component, component)].max(floor[component]);
                    product[component] += damping * entry * value[component];
                }
            }
        }
        for (block, &(a, b)) in off_diagonal.iter().zip(pairs) {
            product[a] += block * vector[b];
            product[b] += block.tr_mul(&vector[a]);
        }
    }
}

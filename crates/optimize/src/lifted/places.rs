//! The best translations for given axes.

use nalgebra::{SMatrix, SVector};
use posecut_cholesky::{Factor, Symbolic};

use super::manifold::Lift;
use crate::certificate::chordal_matrix::ChordalMatrix;

/// The factor of the part of `M` between translations. It is the same for each of their `P` components.
pub(super) struct Places {
    symbolic: Symbolic,
    factor: Factor<1>,
}

impl Places {
    /// `None` if the translations are not determined.
    pub(super) fn new<const M: usize>(matrix: &ChordalMatrix<M>) -> Option<Self> {
        let symbolic = Symbolic::new(matrix.diagonal.len(), &matrix.pairs, 1);
        let mut factor = Factor::new(&symbolic);
        let part = |blocks: &[SMatrix<f64, M, M>]| -> Vec<_> {
            blocks.iter().map(|block| SMatrix::<f64, 1, 1>::new(block[(0, 0)])).collect()
        };
        let (diagonal, off_diagonal) = (part(&matrix.diagonal), part(&matrix.off_diagonal));
        let done = factor.factorize(&symbolic, &diagonal, &off_diagonal, 0.0, [0.0; 1]).is_ok();
        done.then_some(Self { symbolic, factor })
    }

    /// Puts the translations where they cost least. After a step that turns axes, stiff edges would cost more than the step gains: a turn moves all
    /// that lies beyond it along an arc, and the step along the arc's tangent.
    pub(super) fn put<const P: usize, const M: usize>(
        &mut self,
        matrix: &ChordalMatrix<M>,
        x: &mut Lift<P, M>,
    ) {
        for block in x.iter_mut() {
            block.column_mut(0).fill(0.0);
        }
        let pull = matrix.times(x);
        for row in 0..P {
            let mut values: Vec<_> =
                pull.iter().map(|block| SVector::<f64, 1>::new(-block[(row, 0)])).collect();
            self.factor.solve(&self.symbolic, &mut values);
            for (block, value) in x.iter_mut().zip(&values) {
                block[(row, 0)] = value[0];
            }
        }
    }
}

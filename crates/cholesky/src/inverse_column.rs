//! Single blocks of the inverse, also those where the factor has none.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::SMatrix;
use pulp::{Simd, WithSimd};

use crate::fronts::factor::Factor;
use crate::fronts::substitution::{Places, backward, forward};
use crate::instructions::for_small_blocks;
use crate::symbolic::Symbolic;

/// The working memory of solves along the elimination tree: a right-hand side, and the rows of one front.
#[derive(Clone)]
pub struct Workspace {
    values: Vec<f64>,
    local: Vec<f64>,
}

impl<const D: usize> Factor<D> {
    /// Working memory for [`Self::inverse_column`]: one for each thread.
    pub fn workspace(&self) -> Workspace {
        Workspace { values: vec![0.0; self.permuted.len()], local: vec![0.0; self.local.len()] }
    }

    /// The blocks of `A^-1` in block column `column` and the given block rows.
    ///
    /// The triangular solves visit only the fronts on the paths from these variables to the roots of the elimination tree.
    pub fn inverse_column(
        &self,
        symbolic: &Symbolic,
        column: usize,
        rows: &[usize],
        workspace: &mut Workspace,
    ) -> Vec<SMatrix<f64, D, D>> {
        let own = symbolic.path_to_root([column].into_iter());
        let all = symbolic.path_to_root(rows.iter().copied().chain([column]));
        let mut blocks = vec![SMatrix::<f64, D, D>::zeros(); rows.len()];
        let (panels, values, local) = (&self.panels[..], &mut workspace.values[..], &mut workspace.local[..]);
        for component in 0..D {
            for &front in &all {
                let front = &symbolic.fronts[front];
                values[front.first * D..(front.first + front.columns) * D].fill(0.0);
            }
            values[symbolic.position[column] * D + component] = 1.0;
            for_small_blocks(Along::<D> { symbolic, own: &own, all: &all, panels, values, local });
            for (block, &row) in blocks.iter_mut().zip(rows) {
                let start = symbolic.position[row] * D;
                block.as_mut_slice()[component * D..][..D].copy_from_slice(&values[start..start + D]);
            }
        }
        blocks
    }
}

/// Both triangular solves along some paths to the root, for one set of vector instructions: otherwise every product would be
/// a function call.
struct Along<'a, const D: usize> {
    symbolic: &'a Symbolic,
    own: &'a [usize],
    all: &'a [usize],
    panels: &'a [f64],
    values: &'a mut [f64],
    local: &'a mut [f64],
}

impl<const D: usize> WithSimd for Along<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { symbolic, own, all, panels, values, local } = self;
        let mut places = Places { symbolic, first: 0, own: values, top: &mut [] };
        for &front in own {
            forward::<D, f64>(&symbolic.fronts[front], panels, &mut places, local);
        }
        for &front in all.iter().rev() {
            backward::<D, f64>(&symbolic.fronts[front], panels, &mut places, local);
        }
    }
}

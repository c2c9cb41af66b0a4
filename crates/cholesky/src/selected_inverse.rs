//! Blocks of the inverse where the factor has blocks.
//!
//! K. Takahashi, J. Fagan, M.-S. Chen, "Formation of a sparse bus impedance matrix and its application to short circuit
//! study", 1973; here front by front from the roots down, as in Y. E. Campbell and T. A. Davis, "Computing the sparse
//! inverse subset: an inverse multifrontal approach", 1995.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::SMatrix;

use crate::fronts::factor::{Factor, resized};
use crate::symbolic::{Front, Symbolic};

/// The blocks of `A^-1` wherever the factor of `A` has one, which includes the pattern of `A`.
pub struct SelectedInverse<const D: usize> {
    pub(crate) panels: Vec<f64>,
}

impl<const D: usize> std::fmt::Debug for SelectedInverse<D> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("SelectedInverse").field("scalars", &self.panels.len()).finish_non_exhaustive()
    }
}

impl<const D: usize> SelectedInverse<D> {
    /// Computes the blocks from a factor. Takes about twice the operations of the factorisation, and as much memory again.
    ///
    /// With a front's columns `[L; M]`, and `Z_RR` the inverse over the rows `R` below, known from the parent:
    /// `Z_RJ = -Z_RR W` and `Z_JJ = L^-T L^-1 - W^T Z_RJ`, where `W = M L^-1`.
    ///
    /// The factor is only changed in memory that every factorisation overwrites.
    pub fn new(symbolic: &Symbolic, factor: &mut Factor<D>) -> Self {
        let Factor { panels: factor, stacks, inverse, .. } = factor;
        let mut panels = resized(std::mem::take(inverse), factor.len());
        // A child's `Z_RR` is stored as its update matrix was, on a stack. Fronts come in the opposite order.
        let largest = symbolic.fronts.iter().map(|front| front.below() * front.columns).max().unwrap_or(0);
        let mut product = vec![0.0; largest * D * D];
        // Parents come first: the inverse over a front's rows is part of the inverse over its parent's columns and rows.
        for front in symbolic.fronts.iter().rev() {
            let range = front.panel * D * D..(front.panel + front.columns * front.height()) * D * D;
            let panel = &mut panels[range.clone()];
            panel.fill(0.0);
            let [even, odd] = &mut *stacks;
            let (own, others) = if front.stack == 0 { (&*even, odd) } else { (&*odd, even) };
            let below = front.below() * D;
            let corner = &own[front.corner * D * D..][..below * below];
            invert_front(&factor[range], panel, corner, front.columns * D, &mut product);
            for &child in &symbolic.children[front.children.clone()] {
                let child = &symbolic.fronts[child];
                let order = child.below() * D;
                let target = &mut others[child.corner * D * D..][..order * order];
                hand_down::<D>(&symbolic.relative[child.rows.clone()], front, panel, corner, target);
            }
        }
        Self { panels }
    }

    /// The block in block row `row` and block column `column` of `A^-1`; `None` where the factor has no block.
    pub fn block(&self, symbolic: &Symbolic, row: usize, column: usize) -> Option<SMatrix<f64, D, D>> {
        let (at_row, at_column) = (symbolic.position[row], symbolic.position[column]);
        let (upper, lower) = (at_row.min(at_column), at_row.max(at_column));
        let front = &symbolic.fronts[symbolic.front_of[upper]];
        let local_row = if lower < front.first + front.columns {
            lower - front.first
        } else {
            front.columns + symbolic.rows[front.rows.clone()].binary_search(&lower).ok()?
        };
        let height = front.height() * D;
        let start = front.panel * D * D + (upper - front.first) * D * height + local_row * D;
        let block = SMatrix::from_fn(|row, column| self.panels[start + column * height + row]);
        Some(if at_row >= at_column { block } else { block.transpose() })
    }
}

/// Fills `inverse` with `[Z_JJ; Z_RJ]` of one front; `corner` holds `Z_RR`, `product` is working memory.
fn invert_front(factor: &[f64], inverse: &mut [f64], corner: &[f64], columns: usize, product: &mut [f64]) {
    let height = factor.len() / columns;
    let below = height - columns;
    let (diagonal, rest) = MatRef::from_column_major_slice(factor, height, columns).split_at_row(columns);
    let (mut top, mut bottom) =
        MatMut::from_column_major_slice_mut(inverse, height, columns).split_at_row_mut(columns);
    for index in 0..columns {
        top[(index, index)] = 1.0;
    }
    // L^-T L^-1, which is Z_JJ of a root.
    solve_lower_triangular_in_place(diagonal, top.as_mut(), Par::Seq);
    solve_upper_triangular_in_place(diagonal.transpose(), top.as_mut(), Par::Seq);
    if below == 0 {
        return;
    }
    let corner = MatRef::from_column_major_slice(corner, below, below);
    let mut product = MatMut::from_column_major_slice_mut(&mut product[..below * columns], below, columns);
    // W = M L^-1, -Z_RR W, and -W^T (-Z_RR W) added to the top.
    bottom.copy_from(rest);
    solve_upper_triangular_in_place(diagonal.transpose(), bottom.as_mut().transpose_mut(), Par::Seq);
    matmul(product.as_mut(), Accum::Replace, corner, bottom.as_ref(), -1.0, Par::Seq);
    matmul(top, Accum::Add, bottom.as_ref().transpose(), product.as_ref(), -1.0, Par::Seq);
    bottom.copy_from(product.as_ref());
}

/// Copies the inverse over a child's rows, which are rows `places` of its parent's front, to the child.
fn hand_down<const D: usize>(
    places: &[usize],
    parent: &Front,
    panel: &[f64],
    corner: &[f64],
    target: &mut [f64],
) {
    let (height, below, columns) = (parent.height() * D, parent.below() * D, parent.columns * D);
    let scalars = || places.iter().flat_map(|&place| place * D..(place + 1) * D);
    let order = places.len() * D;
    for (column, target) in scalars().zip(target.chunks_exact_mut(order.max(1))) {
        for (row, target) in scalars().zip(target) {
            *target = if column < columns {
                panel[column * height + row]
            } else if row < columns {
                panel[row * height + column]
            } else {
                corner[(column - columns) * below + row - columns]
            };
        }
    }
}

//! Partial Cholesky factorisation of one very large dense front, by all threads.
//!
//! Right-looking by blocks of columns. A thread takes strips of fixed size, so that every number is the same sum in the same
//! order at any number of threads.

use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{MatMut, MatRef, Par};

use super::dense::Scratch;
use super::product::{self, Rows, Target};
use super::view::FrontView;

/// Columns eliminated at a time. One thread factorises the diagonal block, so wider blocks leave the other threads idle;
/// narrower ones need more passes over the rest of the front.
const BLOCK: usize = 128;
/// Rows of a thread's strip: one of this many rows and [`BLOCK`] columns, 200 kB, stays in a processor's cache.
/// The size is fixed, independent of the number of threads, so that the strips give the same sums.
const STRIP: usize = 192;

/// As `dense::eliminate`, up to rounding.
pub(super) fn eliminate(front: FrontView<'_>, memory: &mut Scratch) -> Result<(), usize> {
    let below = front.below();
    let FrontView { panel, height, columns, update, fresh } = front;
    for start in (0..columns).step_by(BLOCK) {
        let width = BLOCK.min(columns - start);
        let (done, later) = panel.split_at_mut((start + width) * height);
        let block = MatMut::from_column_major_slice_mut(&mut done[start * height..], height, width);
        let (mut diagonal, rest) = block.split_at_row_mut(start).1.split_at_row_mut(width);
        let stack = MemStack::new(&mut memory.cholesky);
        cholesky_in_place(
            diagonal.as_mut(),
            faer::prelude::default(),
            Par::Seq,
            stack,
            faer::prelude::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| start + index)?;
        solve_by_strips(diagonal.as_ref(), rest);
        let rows = Rows { values: &done[start * height..], height, first: start + width };
        let mut target = Target { values: later, height, first: start + width, fresh: false };
        product::subtract(&mut target, rows, &mut memory.panels, true);
    }
    let rows = Rows { values: panel, height, first: columns };
    let mut target = Target { values: update, height: below, first: 0, fresh };
    product::subtract(&mut target, rows, &mut memory.panels, true);
    Ok(())
}

/// `rest = rest L^-T`.
fn solve_by_strips(diagonal: MatRef<'_, f64>, rest: MatMut<'_, f64>) {
    let rows = rest.nrows();
    if rows <= STRIP {
        if rows > 0 {
            solve_lower_triangular_in_place(diagonal, rest.transpose_mut(), Par::Seq);
        }
        return;
    }
    let half = (rows / STRIP).div_ceil(2) * STRIP;
    let (first, second) = rest.split_at_row_mut(half);
    rayon::join(|| solve_by_strips(diagonal, first), || solve_by_strips(diagonal, second));
}

#[cfg(test)]
mod tests {
    use super::super::dense;
    use super::*;

    /// Eliminates the front of a matrix `B B^T + c I` by both methods.
    #[test]
    fn strips_give_what_one_piece_does_and_the_same_bits_on_any_number_of_threads() {
        let (height, columns) = (531, 300);
        let entry = |row: usize, column: usize| ((row * 37 + column * 101 + row * column) as f64 * 0.7).sin();
        let mut panel = vec![0.0; height * columns];
        for column in 0..columns {
            for row in column..height {
                panel[column * height + row] = entry(row, column) + if row == column { 400.0 } else { 0.0 };
            }
        }
        let below = height - columns;
        let start: Vec<f64> = (0..below * below).map(|index| (index as f64 * 0.3).cos()).collect();
        let solve = |threads: usize, fresh: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            let (mut panel, mut update) = (panel.clone(), start.clone());
            let mut memory = dense::scratch(columns);
            let front = FrontView { panel: &mut panel, height, columns, update: &mut update, fresh };
            pool.install(|| eliminate(front, &mut memory)).expect("the matrix is dominated by its diagonal");
            (panel, update)
        };
        for fresh in [false, true] {
            let (mut expected, mut update) = (panel.clone(), start.clone());
            let mut memory = dense::scratch(columns);
            let front = FrontView { panel: &mut expected, height, columns, update: &mut update, fresh };
            dense::eliminate_by_blocks::<3>(front, true, &mut memory.panels)
                .expect("the matrix is dominated by its diagonal");
            let (found, found_update) = solve(1, fresh);
            let lower = |matrix: &[f64], order: usize, columns: usize| -> Vec<f64> {
                (0..columns)
                    .flat_map(|column| matrix[column * order + column..(column + 1) * order].to_vec())
                    .collect()
            };
            let apart =
                |a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart(lower(&expected, height, columns), lower(&found, height, columns)) < 1e-11);
            assert!(apart(lower(&update, below, below), lower(&found_update, below, below)) < 1e-11);
            assert_eq!(solve(2, fresh), solve(1, fresh));
            assert_eq!(solve(3, fresh), solve(1, fresh));
        }
        let mut indefinite = panel.clone();
        indefinite[200 * height + 200] = -1e6;
        let mut memory = dense::scratch(columns);
        let front =
            FrontView { panel: &mut indefinite, height, columns, update: &mut start.clone(), fresh: true };
        let outcome = eliminate(front, &mut memory);
        assert_eq!(outcome, Err(200));
    }
}

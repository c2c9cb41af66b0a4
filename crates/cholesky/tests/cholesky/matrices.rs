//! Matrices to factorise.

use nalgebra::{DMatrix, SMatrix};
use rand::{Rng, RngExt};

pub(crate) type Blocks<const D: usize> = (Vec<SMatrix<f64, D, D>>, Vec<SMatrix<f64, D, D>>, DMatrix<f64>);

/// A positive definite matrix with this pattern, as blocks and dense.
pub(crate) fn matrix<const D: usize>(
    variables: usize,
    pairs: &[(usize, usize)],
    random: &mut impl Rng,
) -> Blocks<D> {
    let mut draw = || random.random_range(-1.0..1.0);
    let mut dense = DMatrix::zeros(variables * D, variables * D);
    let off_diagonal: Vec<_> = pairs.iter().map(|_| SMatrix::<f64, D, D>::from_fn(|_, _| draw())).collect();
    for (&(a, b), block) in pairs.iter().zip(&off_diagonal) {
        for row in 0..D {
            for column in 0..D {
                dense[(a * D + row, b * D + column)] = block[(row, column)];
                dense[(b * D + column, a * D + row)] = block[(row, column)];
            }
        }
    }
    // Slightly diagonally dominant.
    for index in 0..variables * D {
        dense[(index, index)] = dense.row(index).iter().map(|entry| entry.abs()).sum::<f64>() + 0.5;
    }
    let diagonal = (0..variables).map(|v| dense.fixed_view::<D, D>(v * D, v * D).into_owned()).collect();
    (diagonal, off_diagonal, dense)
}

/// Pairs of different variables, each once, the smaller first.
pub(crate) fn unique_pairs(variables: usize, raw: &[(usize, usize)]) -> Vec<(usize, usize)> {
    let mut pairs: Vec<_> = raw
        .iter()
        .map(|&(a, b)| (a % variables, b % variables))
        .filter(|(a, b)| a != b)
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Neighbours in a square grid, row by row.
pub(crate) fn grid(side: usize) -> Vec<(usize, usize)> {
    let node = |row: usize, column: usize| row * side + column;
    let mut pairs = Vec::new();
    for row in 0..side {
        for column in 0..side {
            if column + 1 < side {
                pairs.push((node(row, column), node(row, column + 1)));
            }
            if row + 1 < side {
                pairs.push((node(row, column), node(row + 1, column)));
            }
        }
    }
    pairs
}

/// Pairs, diagonal and off-diagonal blocks of a grid that is large enough for threads.
type Large = (Vec<(usize, usize)>, Vec<SMatrix<f64, 6, 6>>, Vec<SMatrix<f64, 6, 6>>);

/// A diagonally dominant matrix on a square grid whose factorisation is divided among threads.
pub(crate) fn large_grid(random: &mut impl Rng) -> Large {
    let side = 70;
    let pairs = grid(side);
    let off_diagonal =
        pairs.iter().map(|_| SMatrix::from_fn(|_, _| random.random_range(-1.0..1.0))).collect();
    // Each of the four neighbours contributes six entries of at most one to a row.
    let diagonal = vec![SMatrix::identity() * 25.0; side * side];
    (pairs, diagonal, off_diagonal)
}

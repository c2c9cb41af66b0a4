//! From more dimensions back to the original ones.
//!
//! Where the relaxation is tight, the axes of all poses lie in one space of `N` dimensions, and the projection to it is exact. Where false
//! edges or noise turn parts of the graph out of it, every projection bends some parts, and each may lead to another minimum. So several
//! spaces are drawn at random, as hyperplanes are in M. X. Goemans, D. P. Williamson, "Improved approximation algorithms for maximum cut
//! and satisfiability problems using semidefinite programming", J. ACM 42(6), 1995.

use nalgebra::{DMatrix, SMatrix, SVector};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::manifold::{Lift, orthonormalise};

/// Up to this share of the axes' squares outside the principal space, the relaxation counts as tight.
const TIGHT: f64 = 0.01;

/// Number of spaces if it is not. With 4 instead of 8, a lower minimum than that found was known on 17 of 65 graphs with false edges or noise, not
/// on 11.
const SPACES: usize = 8;

/// Orthonormal bases of the spaces to project to: the principal one, which the axes share most, and others near it if the relaxation is not
/// tight.
pub(super) fn spaces<const N: usize, const M: usize, const P: usize>(
    lifted: &Lift<P, M>,
    random: &mut ChaCha8Rng,
) -> Vec<SMatrix<f64, P, N>> {
    let (directions, squares) = principal_directions(lifted);
    let mut spaces = vec![directions.fixed_columns::<N>(0).into_owned()];
    if squares.rows_range(N..).sum() > TIGHT * squares.sum() {
        spaces.resize_with(SPACES, || directions * random_frame::<N, M, P>(&squares, random));
    }
    spaces
}

/// The blocks in a space, right-handed for most of them.
pub(super) fn project_to<const N: usize, const M: usize, const P: usize>(
    lifted: &Lift<P, M>,
    space: &SMatrix<f64, P, N>,
) -> Vec<SMatrix<f64, N, M>> {
    let mut flat: Vec<SMatrix<f64, N, M>> = lifted.iter().map(|block| space.tr_mul(block)).collect();
    let mirrored = |block: &&SMatrix<f64, N, M>| {
        DMatrix::from_fn(N, N, |row, column| block[(row, column + 1)]).determinant() < 0.0
    };
    if 2 * flat.iter().filter(mirrored).count() > flat.len() {
        for block in &mut flat {
            block.row_mut(N - 1).neg_mut();
        }
    }
    flat
}

/// The directions in which all axes together are longest, as columns, and the sums of their squared components there; the greatest first.
fn principal_directions<const M: usize, const P: usize>(
    lifted: &Lift<P, M>,
) -> (SMatrix<f64, P, P>, SVector<f64, P>) {
    let mut gram = DMatrix::<f64>::zeros(P, P);
    for block in lifted {
        let axes = block.columns(1, M - 1);
        gram += axes * axes.transpose();
    }
    let eigen = gram.symmetric_eigen();
    let mut order: Vec<usize> = (0..P).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let directions = SMatrix::from_fn(|row, column| eigen.eigenvectors[(row, order[column])]);
    (directions, SVector::from_fn(|row, _| eigen.eigenvalues[order[row]]))
}

/// `N` orthonormal vectors near the first `N` unit vectors. A component is turned by up to the length of the axes in its direction, as a
/// share of the greatest.
fn random_frame<const N: usize, const M: usize, const P: usize>(
    squares: &SVector<f64, P>,
    random: &mut ChaCha8Rng,
) -> SMatrix<f64, P, N> {
    let mut block = SMatrix::<f64, P, M>::zeros();
    for (index, mut axis) in block.fixed_columns_mut::<N>(1).column_iter_mut().enumerate() {
        axis[index] = 1.0;
        for (component, square) in axis.iter_mut().zip(squares) {
            let length = (square / squares[0]).max(0.0).sqrt();
            *component += length * random.random_range(-1.0..1.0);
        }
    }
    orthonormalise(block).fixed_columns::<N>(1).into_owned()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;

    use super::*;

    fn plane(angle: f64) -> SMatrix<f64, 4, 3> {
        let (sine, cosine) = angle.sin_cos();
        SMatrix::from_row_slice(&[1.0, cosine, -sine, 2.0, sine, cosine, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// Poses in one plane of four dimensions: one space, and the angles between them come back.
    #[test]
    fn the_projection_is_exact_where_the_relaxation_is_tight() {
        let turn =
            orthonormalise(SMatrix::<f64, 4, 5>::from_fn(|row, column| ((row * 5 + column) as f64).sin()));
        let turn = turn.fixed_columns::<4>(1);
        let angles = [0.3, -3.1, 3.1, 1.0];
        let lifted: Lift<4, 3> = angles.iter().map(|&angle| turn * plane(angle)).collect();
        let spaces = spaces::<2, 3, 4>(&lifted, &mut ChaCha8Rng::seed_from_u64(1));
        assert_eq!(spaces.len(), 1);
        let flat = project_to(&lifted, &spaces[0]);
        let first = flat[0].fixed_columns::<2>(1).into_owned();
        for (block, angle) in flat.iter().zip(angles) {
            let between = first.tr_mul(&block.fixed_columns::<2>(1));
            let (sine, cosine) = (angle - angles[0]).sin_cos();
            assert!((between - SMatrix::from_row_slice(&[cosine, -sine, sine, cosine])).amax() < 1e-12);
        }
    }

    /// Half of the poses in one plane, half in another: several spaces, all different, with orthonormal bases.
    #[test]
    fn several_spaces_are_drawn_where_the_relaxation_is_not_tight() {
        let other = |block: SMatrix<f64, 4, 3>| {
            SMatrix::<f64, 4, 3>::from_fn(|row, column| block[((row + 2) % 4, column)])
        };
        let lifted: Lift<4, 3> =
            vec![plane(0.3), plane(-2.0), other(plane(1.0)), other(plane(2.5)), plane(3.0)];
        let spaces = spaces::<2, 3, 4>(&lifted, &mut ChaCha8Rng::seed_from_u64(1));
        assert_eq!(spaces.len(), SPACES);
        for (index, space) in spaces.iter().enumerate() {
            assert!((space.tr_mul(space) - SMatrix::<f64, 2, 2>::identity()).amax() < 1e-12);
            let same =
                |earlier: &SMatrix<f64, 4, 2>| (earlier.tr_mul(space).determinant().abs() - 1.0).abs() < 1e-3;
            assert!(!spaces[..index].iter().any(same));
        }
    }
}

//! Factors in single precision: solutions near those in double precision, and matrices that are too hard for them.

use nalgebra::{SMatrix, SVector};
use posecut_cholesky::{End, Factor, Matrix, Memory, MixedFactor, Symbolic};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::matrices::{grid, large_grid, matrix, unique_pairs};

/// The largest entries of the difference of two vectors, and of the second one.
fn apart<const D: usize>(found: &[SVector<f64, D>], expected: &[SVector<f64, D>]) -> (f64, f64) {
    let difference = found.iter().zip(expected).map(|(found, expected)| (found - expected).amax());
    (difference.fold(0.0, f64::max), expected.iter().map(SVector::amax).fold(0.0, f64::max))
}

/// Solves in single precision with refinement and in double precision; returns both, and whether single precision sufficed.
fn both<const D: usize>(
    symbolic: &Symbolic,
    pairs: &[(usize, usize)],
    matrix: Matrix<'_, D>,
    right: &[SVector<f64, D>],
) -> (Vec<SVector<f64, D>>, Vec<SVector<f64, D>>, bool) {
    let Matrix { diagonal, off_diagonal, damping, floor } = matrix;
    let mut mixed = MixedFactor::single(symbolic);
    let mut found = right.to_vec();
    mixed.factorize(symbolic, matrix).unwrap();
    mixed.solve(symbolic, pairs, matrix, &mut found).unwrap();
    let mut double = Factor::new(symbolic);
    let mut expected = right.to_vec();
    double.factorize(symbolic, diagonal, off_diagonal, damping, floor).unwrap();
    double.solve(symbolic, &mut expected);
    (found, expected, mixed.is_single())
}

fn check<const D: usize>(variables: usize, pairs: &[(usize, usize)], seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (diagonal, off_diagonal, _) = matrix::<D>(variables, pairs, &mut random);
    let symbolic = Symbolic::new(variables, pairs, D);
    for (damping, floor) in [(0.0, 0.0), (0.3, 2.0)] {
        let matrix = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping, floor: [floor; D] };
        let right: Vec<SVector<f64, D>> =
            (0..variables).map(|_| SVector::from_fn(|_, _| random.random_range(-1e3..1e3))).collect();
        let (found, expected, is_single) = both(&symbolic, pairs, matrix, &right);
        let (difference, largest) = apart(&found, &expected);
        assert!(difference <= 1e-5 * largest, "{difference:e} of {largest:e}");
        assert!(is_single);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn solutions_are_those_of_double_precision(variables in 1_usize..40, raw in proptest::collection::vec((0_usize..40, 0_usize..40), 0..120), seed: u64) {
        let pairs = unique_pairs(variables, &raw);
        check::<1>(variables, &pairs, seed);
        check::<3>(variables, &pairs, seed);
        check::<6>(variables, &pairs, seed);
    }
}

#[test]
fn solutions_of_grids_whose_fronts_are_large_are_those_of_double_precision() {
    check::<6>(40 * 40, &grid(40), 1);
}

/// The pairs of a chain.
fn links(count: usize) -> Vec<(usize, usize)> {
    (1..count).map(|variable| (variable - 1, variable)).collect()
}

/// A chain of `count` springs of stiffness one whose first end is held by a spring of this stiffness.
fn chain(count: usize, held_by: f64) -> (Vec<SMatrix<f64, 1, 1>>, Vec<SMatrix<f64, 1, 1>>, Symbolic) {
    let mut diagonal = vec![SMatrix::<f64, 1, 1>::new(2.0); count];
    diagonal[0] = SMatrix::<f64, 1, 1>::new(1.0 + held_by);
    diagonal[count - 1] = SMatrix::<f64, 1, 1>::new(1.0);
    let off_diagonal = vec![SMatrix::<f64, 1, 1>::new(-1.0); count - 1];
    (diagonal, off_diagonal, Symbolic::new(count, &links(count), 1))
}

/// The weaker the hold, the nearer to singular; the softest direction is a trillionth of the stiffest one. The solution under a
/// unit force at every node is known: the hold moves by `count / held_by`.
#[test]
fn soft_chains_are_solved() {
    let count = 2000;
    for held_by in [1.0, 1e-3, 1e-6, 1e-9] {
        let (diagonal, off_diagonal, symbolic) = chain(count, held_by);
        let matrix = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping: 0.0, floor: [0.0] };
        let right = vec![SVector::<f64, 1>::new(1.0); count];
        let (found, _, is_single) = both(&symbolic, &links(count), matrix, &right);
        assert!(is_single);
        let exact = count as f64 / held_by;
        let error = (found[0].x / exact - 1.0).abs();
        assert!(error < 1e-4, "held by {held_by:e}: {error:e}");
    }
}

/// Single precision holds the factors of neither of these: they exceed its range at one end or the other.
#[test]
fn numbers_outside_the_range_of_single_precision_are_solved_in_double_precision() {
    for scale in [1e-120, 1e120] {
        let (mut diagonal, mut off_diagonal, symbolic) = chain(50, 1.0);
        for block in diagonal.iter_mut().chain(&mut off_diagonal) {
            *block *= scale;
        }
        let matrix = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping: 0.0, floor: [0.0] };
        let (found, expected, is_single) =
            both(&symbolic, &links(50), matrix, &[SVector::<f64, 1>::new(scale); 50]);
        assert!(!is_single);
        assert_eq!(found, expected);
    }
    // Right-hand sides have no such limit.
    let (diagonal, off_diagonal, symbolic) = chain(50, 1.0);
    let matrix = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping: 0.0, floor: [0.0] };
    for scale in [0.0, 1e-60, 1e60] {
        let (found, expected, is_single) =
            both(&symbolic, &links(50), matrix, &[SVector::<f64, 1>::new(scale); 50]);
        let (difference, largest) = apart(&found, &expected);
        assert!(is_single && difference <= 1e-6 * largest);
    }
}

/// Errors name the same variable as in double precision, and a matrix that is singular to working precision is seen.
#[test]
fn singular_and_indefinite_matrices_are_told_as_in_double_precision() {
    let (mut diagonal, off_diagonal, symbolic) = chain(30, 0.0);
    let mut mixed = MixedFactor::single(&symbolic);
    let singular = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping: 0.0, floor: [0.0] };
    let outcome = mixed.factorize(&symbolic, singular);
    assert!(outcome.is_err() || mixed.undetermined().is_some());
    diagonal[17] = SMatrix::<f64, 1, 1>::new(-1.0);
    let indefinite = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping: 0.0, floor: [0.0] };
    let mut mixed = MixedFactor::single(&symbolic);
    let error = mixed.factorize(&symbolic, indefinite).unwrap_err();
    let mut double = Factor::<1>::new(&symbolic);
    assert_eq!(error, double.factorize(&symbolic, &diagonal, &off_diagonal, 0.0, [0.0]).unwrap_err());
}

#[test]
fn a_small_factor_is_in_double_precision() {
    let (_, _, symbolic) = chain(30, 1.0);
    assert!(!MixedFactor::<1>::with_memory(&symbolic, Memory::default()).is_single());
}

/// A factor whose stretches run on several threads: the solution is that of one thread to the bit.
#[test]
fn threads_change_no_bit() {
    let (pairs, diagonal, off_diagonal) = large_grid(&mut ChaCha8Rng::seed_from_u64(5));
    let variables = diagonal.len();
    let matrix = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping: 0.0, floor: [0.0; 6] };
    let right = vec![SVector::<f64, 6>::repeat(1.0); variables];
    let solve = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let symbolic = pool.install(|| Symbolic::new(variables, &pairs, 6));
        let (found, expected, is_single) = pool.install(|| both(&symbolic, &pairs, matrix, &right));
        let (difference, largest) = apart(&found, &expected);
        assert!(is_single && difference <= 1e-5 * largest);
        found
    };
    let one = solve(1);
    for threads in [2, 3] {
        assert!(solve(threads) == one, "{threads} threads");
    }
}

/// A factor solves with a matrix that differs from its own, and says how much is left; with too few iterations it changes nothing.
#[test]
fn a_factor_solves_with_another_matrix() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let pairs = grid(9);
    let variables = 81;
    let (diagonal, off_diagonal, _) = matrix::<3>(variables, &pairs, &mut random);
    let stiffer: Vec<_> = diagonal
        .iter()
        .map(|block| {
            block + SMatrix::from_diagonal(&SVector::from([0.5, 0.0, 2.0]).component_mul(&block.diagonal()))
        })
        .collect();
    let symbolic = Symbolic::new(variables, &pairs, 3);
    let other = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping: 0.0, floor: [0.0; 3] };
    let own = Matrix { diagonal: &stiffer, ..other };
    let right = vec![SVector::<f64, 3>::repeat(1.0); variables];
    for mut factor in [MixedFactor::single(&symbolic), MixedFactor::with_memory(&symbolic, Memory::default())]
    {
        factor.factorize(&symbolic, own).unwrap();
        let mut values = right.clone();
        let few = End { iterations: 1, left: 1e-12, enough: 0.0 };
        assert!(factor.iterate(&symbolic, &pairs, other, &mut values, few).is_none() && values == right);
        let mut expected = right.clone();
        let mut exact = Factor::<3>::new(&symbolic);
        exact.factorize(&symbolic, &diagonal, &off_diagonal, 0.0, [0.0; 3]).unwrap();
        exact.solve(&symbolic, &mut expected);
        let decrease = |values: &[SVector<f64, 3>]| -> f64 { values.iter().map(SVector::sum).sum() };
        for left in [1e-2, 1e-6, 1e-12] {
            let mut values = right.clone();
            let end = End { iterations: 100, left, enough: 0.0 };
            let rest = factor.iterate(&symbolic, &pairs, other, &mut values, end).unwrap();
            let missing = decrease(&expected) - decrease(&values);
            assert!(
                rest <= left * decrease(&values) && missing < 10.0 * left * decrease(&expected),
                "{left}"
            );
        }
        // Enough is enough.
        let mut values = right.clone();
        let end = End { iterations: 2, left: 0.0, enough: 10.0 * decrease(&expected) };
        assert!(factor.iterate(&symbolic, &pairs, other, &mut values, end).is_some());
    }
}

/// The memory of a factor in single precision serves a factor with smaller blocks, itself again, and another factor after it, all with the
/// bits that new memory gives.
#[test]
fn memory_of_single_precision_is_lent_and_handed_on() {
    let (pairs, diagonal, off_diagonal) = large_grid(&mut ChaCha8Rng::seed_from_u64(5));
    let variables = diagonal.len();
    let symbolic = Symbolic::new(variables, &pairs, 6);
    let small = |blocks: &[SMatrix<f64, 6, 6>]| -> Vec<SMatrix<f64, 3, 3>> {
        blocks.iter().map(|block| block.fixed_view::<3, 3>(0, 0).into_owned()).collect()
    };
    let (small_diagonal, small_off_diagonal) = (small(&diagonal), small(&off_diagonal));
    let solve = |factor: &mut Factor<3>| {
        let mut values = vec![SVector::<f64, 3>::repeat(1.0); variables];
        factor.factorize(&symbolic, &small_diagonal, &small_off_diagonal, 0.0, [0.0; 3]).unwrap();
        factor.solve(&symbolic, &mut values);
        values
    };
    let matrix = Matrix { diagonal: &diagonal, off_diagonal: &off_diagonal, damping: 0.0, floor: [0.0; 6] };
    let precondition = |factor: &mut MixedFactor<6>| {
        let mut values = vec![SVector::<f64, 6>::repeat(1.0); variables];
        factor.factorize(&symbolic, matrix).unwrap();
        factor.precondition(&symbolic, &mut values);
        values
    };
    let mut mixed = MixedFactor::<6>::single(&symbolic);
    assert!(mixed.lend(solve) == solve(&mut Factor::new(&symbolic)));
    assert!(precondition(&mut mixed) == precondition(&mut MixedFactor::single(&symbolic)));
    let mut next = MixedFactor::with_memory(&symbolic, mixed.into_memory());
    assert!(!next.is_single());
    assert!(
        precondition(&mut next) == precondition(&mut MixedFactor::with_memory(&symbolic, Memory::default()))
    );
}

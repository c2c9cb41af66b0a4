//! The block factorisation against dense algebra, over random patterns.

use nalgebra::{DVector, SMatrix, SVector};
use posecut_cholesky::{Factor, SelectedInverse, Symbolic};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::matrices::{grid, large_grid, matrix, unique_pairs};

fn check<const D: usize>(variables: usize, pairs: &[(usize, usize)], seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (diagonal, off_diagonal, dense) = matrix::<D>(variables, pairs, &mut random);
    let symbolic = Symbolic::new(variables, pairs, D);
    let mut factor = Factor::<D>::new(&symbolic);
    // Two runs, so that leftovers of the first one would show.
    for damping in [0.3, 0.0] {
        factor.factorize(&symbolic, &diagonal, &off_diagonal, damping, [0.0; D]).unwrap();
        let mut values: Vec<SVector<f64, D>> =
            (0..variables).map(|_| SVector::from_fn(|_, _| random.random_range(-1.0..1.0))).collect();
        let right = DVector::from_iterator(variables * D, values.iter().flat_map(|v| v.iter().copied()));
        factor.solve(&symbolic, &mut values);
        let found = DVector::from_iterator(variables * D, values.iter().flat_map(|v| v.iter().copied()));
        let mut damped = dense.clone();
        for index in 0..variables * D {
            damped[(index, index)] *= 1.0 + damping;
        }
        let rest = (damped * &found - &right).amax();
        assert!(rest < 1e-11 * (1.0 + found.amax()), "{rest}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn solves_any_pattern(variables in 1_usize..40, raw in proptest::collection::vec((0_usize..40, 0_usize..40), 0..120), seed: u64) {
        let pairs = unique_pairs(variables, &raw);
        check::<2>(variables, &pairs, seed);
        check::<3>(variables, &pairs, seed);
        check::<6>(variables, &pairs, seed);
    }
}

#[test]
fn solves_grids_whose_fronts_are_large() {
    let side = 16;
    let mut pairs = grid(side);
    pairs.extend((0..side - 4).flat_map(|row| {
        (0..side - 3).map(move |column| (row * side + column, (row + 4) * side + column + 3))
    }));
    pairs.sort_unstable();
    check::<3>(side * side, &pairs, 1);
    check::<6>(side * side, &pairs, 2);
    let symbolic = Symbolic::new(side * side, &pairs, 6);
    assert!(symbolic.factor_blocks() > pairs.len() + side * side);
    assert!(symbolic.flops() > 1e6);
}

#[test]
fn an_empty_matrix_is_solved() {
    check::<3>(0, &[], 0);
}

#[test]
fn indefinite_and_singular_matrices_are_told_by_variable() {
    let pairs = [(0, 1), (1, 2)];
    let symbolic = Symbolic::new(3, &pairs, 2);
    let mut factor = Factor::<2>::new(&symbolic);
    let identity = SMatrix::<f64, 2, 2>::identity();
    let zero = SMatrix::<f64, 2, 2>::zeros();
    let mut last = identity;
    last[(1, 1)] = -1.0;
    let breakdown =
        factor.factorize(&symbolic, &[identity, identity, last], &[zero, zero], 0.0, [0.0; 2]).unwrap_err();
    assert_eq!((breakdown.variable, breakdown.component), (2, 1));
    assert!(breakdown.to_string().contains("component 1 of variable 2"), "{breakdown}");
    last[(1, 1)] = f64::NAN;
    assert!(factor.factorize(&symbolic, &[identity, identity, last], &[zero, zero], 0.0, [0.0; 2]).is_err());
    // The chain 0 - 1 - 2 without any fixed variable: singular.
    let laplacian = [identity, identity * 2.0, identity * (1.0 + 1e-15)];
    if factor.factorize(&symbolic, &laplacian, &[-identity, -identity], 0.0, [0.0; 2]).is_ok() {
        assert!(factor.smallest_pivot().0 < 1e-14);
    }
    factor.factorize(&symbolic, &[zero; 3], &[zero, zero], 1.0, [1.0; 2]).unwrap();
}

/// On a grid whose factorisation is divided among threads, the solution and the inverse are right, and the same to the bit on any number
/// of them.
#[test]
fn threads_change_no_bit() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let (pairs, diagonal, off_diagonal) = large_grid(&mut random);
    let variables = diagonal.len();
    let right: Vec<SVector<f64, 6>> =
        (0..variables).map(|_| SVector::from_fn(|_, _| random.random_range(-1.0..1.0))).collect();
    let symbolic = Symbolic::new(variables, &pairs, 6);
    assert!(symbolic.flops() > 2e8, "{:e} operations are too few to be divided", symbolic.flops());
    let solve = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut values = right.clone();
        // The analysis, too, depends on whether there are several threads.
        let symbolic = pool.install(|| Symbolic::new(variables, &pairs, 6));
        let mut factor = Factor::<6>::new(&symbolic);
        pool.install(|| factor.factorize(&symbolic, &diagonal, &off_diagonal, 0.0, [0.0; 6])).unwrap();
        factor.solve(&symbolic, &mut values);
        let (some, mut workspace) = (variables / 2, factor.workspace());
        let column = factor.inverse_column(&symbolic, some, &[some], &mut workspace)[0];
        let inverse = SelectedInverse::new(&symbolic, &mut factor);
        let blocks: Vec<_> = pairs.iter().map(|&(a, b)| inverse.block(&symbolic, a, b).unwrap()).collect();
        assert!((inverse.block(&symbolic, some, some).unwrap() - column).amax() < 1e-14);
        (values, factor.smallest_pivot(), blocks)
    };
    let (values, pivot, blocks) = solve(1);
    let mut rest: Vec<SVector<f64, 6>> = values.iter().zip(&right).map(|(x, b)| x * 25.0 - b).collect();
    for (&(a, b), block) in pairs.iter().zip(&off_diagonal) {
        rest[a] += block * values[b];
        rest[b] += block.transpose() * values[a];
    }
    let largest = rest.iter().map(SVector::amax).fold(0.0, f64::max);
    assert!(largest < 1e-12, "{largest}");
    for threads in [2, 3] {
        assert!(solve(threads) == (values.clone(), pivot, blocks.clone()), "{threads} threads");
    }
    // If several blocks fail, in subtrees and above them, the error names the same one at any number of threads.
    for count in [1, 7, 300] {
        let mut indefinite = diagonal.clone();
        for _ in 0..count {
            indefinite[random.random_range(0..variables)] = SMatrix::identity() * -1.0;
        }
        let fail = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let symbolic = pool.install(|| Symbolic::new(variables, &pairs, 6));
            let mut factor = Factor::<6>::new(&symbolic);
            pool.install(|| factor.factorize(&symbolic, &indefinite, &off_diagonal, 0.0, [0.0; 6]))
                .unwrap_err()
        };
        assert_eq!(fail(1), fail(2), "{count}");
    }
}

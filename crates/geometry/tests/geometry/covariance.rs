//! Tests of propagation (against sampling and finite differences), conversion, packing and definiteness.

use crate::tangents::{planar_tangent, spatial_tangent};
use nalgebra::{Matrix2, Matrix3, Matrix6, SMatrix, SVector, Vector3};
use posecut_geometry::covariance::{
    self, CovarianceError, Definiteness, covariance_from_information, definiteness,
    information_from_covariance, pack_upper_triangle, unpack_upper_triangle,
};
use posecut_geometry::{LieGroup, SE2, SE3};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A full covariance with a known square root.
fn root<const N: usize>(random: &mut ChaCha8Rng, size: f64) -> SMatrix<f64, N, N> {
    SMatrix::from_fn(|_, _| {
        let draw: f64 = StandardNormal.sample(random);
        draw * size
    })
}

/// Derivative of `operation` with respect to a right perturbation of its argument, by central differences.
fn derivative<G: LieGroup<DOF>, const DOF: usize>(
    operation: impl Fn(&SVector<f64, DOF>) -> G,
) -> SMatrix<f64, DOF, DOF> {
    let step = 1e-6;
    let centre = operation(&SVector::zeros());
    let mut jacobian = SMatrix::<f64, DOF, DOF>::zeros();
    for axis in 0..DOF {
        let mut offset = SVector::<f64, DOF>::zeros();
        offset[axis] = step;
        let column = (centre.between(&operation(&offset)).log() - centre.between(&operation(&-offset)).log())
            / (2.0 * step);
        jacobian.set_column(axis, &column);
    }
    jacobian
}

/// Compares every propagation with `J Sigma J^T` for a numerical J.
fn check_propagation<G: LieGroup<DOF>, const DOF: usize>(a: &G, b: &G, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (root_a, root_b) = (root::<DOF>(&mut random, 1.0), root::<DOF>(&mut random, 1.0));
    let sigma_a = root_a * root_a.transpose();
    let sigma_b = root_b * root_b.transpose();
    let cross = root_a * root_b.transpose() * 0.5;
    let close = |found: SMatrix<f64, DOF, DOF>, expected: SMatrix<f64, DOF, DOF>| {
        let scale = 1.0 + expected.amax();
        assert!((found - expected).amax() < 1e-7 * scale, "{found} {expected}");
        assert_eq!(found, found.transpose());
    };

    let by_a = derivative(|xi| a.compose(&G::exp(xi)).compose(b));
    let by_b = derivative(|xi| a.compose(&b.compose(&G::exp(xi))));
    let joint =
        |by_a: SMatrix<f64, DOF, DOF>, by_b: SMatrix<f64, DOF, DOF>, cross: SMatrix<f64, DOF, DOF>| {
            by_a * sigma_a * by_a.transpose()
                + by_b * sigma_b * by_b.transpose()
                + by_a * cross * by_b.transpose()
                + by_b * cross.transpose() * by_a.transpose()
        };
    close(covariance::compose(&sigma_a, b, &sigma_b), joint(by_a, by_b, SMatrix::zeros()));
    close(covariance::compose_correlated(&sigma_a, b, &sigma_b, &cross), joint(by_a, by_b, cross));

    let by_a = derivative(|xi| a.compose(&G::exp(xi)).between(b));
    let by_b = derivative(|xi| a.between(&b.compose(&G::exp(xi))));
    close(covariance::between(a, &sigma_a, b, &sigma_b), joint(by_a, by_b, SMatrix::zeros()));
    close(covariance::between_correlated(a, &sigma_a, b, &sigma_b, &cross), joint(by_a, by_b, cross));

    let by_a = derivative(|xi| a.compose(&G::exp(xi)).inverse());
    close(covariance::inverse(a, &sigma_a), by_a * sigma_a * by_a.transpose());

    // Left perturbation of the same pose: Exp(eta) T = T Exp(xi).
    let by_left = derivative(|eta| G::exp(eta).compose(a));
    close(covariance::to_body(a, &sigma_a), by_left * sigma_a * by_left.transpose());
    let there_and_back = covariance::to_body(a, &covariance::to_reference(a, &sigma_a));
    assert!((there_and_back - sigma_a).amax() < 1e-9 * (1.0 + sigma_a.amax() * 100.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn propagation_in_the_plane_is_first_order_exact(a in planar_tangent(), b in planar_tangent(), seed: u64) {
        check_propagation(&SE2::exp(&a), &SE2::exp(&b), seed);
    }

    #[test]
    fn propagation_in_space_is_first_order_exact(a in spatial_tangent(), b in spatial_tangent(), seed: u64) {
        check_propagation(&SE3::exp(&a), &SE3::exp(&b), seed);
    }

    #[test]
    fn information_is_the_inverse_whatever_the_units(seed: u64, exponents in proptest::array::uniform6(-6.0..6.0_f64)) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let square = root::<6>(&mut random, 0.3) + Matrix6::identity() * 2.0;
        let units = Matrix6::from_diagonal(&SVector::from(exponents.map(|exponent| 10_f64.powf(exponent))));
        let matrix = units * square * square.transpose() * units;
        let symmetric = (matrix + matrix.transpose()) * 0.5;
        let inverse = covariance_from_information(&symmetric).unwrap();
        prop_assert_eq!(inverse, inverse.transpose());
        let product = units * inverse * symmetric * units.try_inverse().unwrap();
        prop_assert!((product - Matrix6::identity()).amax() < 1e-9, "{}", product);
        let back = information_from_covariance(&inverse).unwrap();
        for (found, expected) in back.iter().zip(symmetric.iter()) {
            prop_assert!((found - expected).abs() <= 1e-9 * symmetric.amax());
        }
    }

    #[test]
    fn packing_is_row_major_and_survives_a_round_trip(terms in proptest::collection::vec(-9.0..9.0_f64, 21)) {
        let matrix = unpack_upper_triangle::<6>(&terms).unwrap();
        prop_assert_eq!(matrix, matrix.transpose());
        prop_assert_eq!(matrix[(0, 5)], terms[5]);
        prop_assert_eq!(matrix[(1, 1)], terms[6]);
        prop_assert_eq!(matrix[(5, 4)], terms[19]);
        prop_assert_eq!(pack_upper_triangle(&matrix), terms);
    }
}

#[test]
fn propagation_agrees_with_sampling() {
    let (a, b) =
        (SE3::from_euler(1.0, -2.0, 0.5, 0.2, -0.7, 2.8), SE3::from_euler(3.0, 1.0, -1.0, -0.4, 0.3, -1.9));
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (root_a, root_b) = (root::<6>(&mut random, 0.01), root::<6>(&mut random, 0.01));
    let (sigma_a, sigma_b) = (root_a * root_a.transpose(), root_b * root_b.transpose());
    let centre = a.between(&b);
    let draws = 40_000;
    let mut sampled = Matrix6::zeros();
    for _ in 0..draws {
        let a = a.compose(&SE3::exp(
            &(root_a * SVector::<f64, 6>::from_fn(|_, _| StandardNormal.sample(&mut random))),
        ));
        let b = b.compose(&SE3::exp(
            &(root_b * SVector::<f64, 6>::from_fn(|_, _| StandardNormal.sample(&mut random))),
        ));
        let error = centre.between(&a.between(&b)).log();
        sampled += error * error.transpose() / f64::from(draws);
    }
    let predicted = covariance::between(&a, &sigma_a, &b, &sigma_b);
    // The standard error of a sampled variance is sqrt(2/n) = 0.7 % of it.
    let relative = (sampled - predicted).amax() / predicted.amax();
    assert!(relative < 0.03, "{relative}");
}

#[test]
fn matrices_without_an_inverse_are_refused_by_name() {
    let mut matrix = Matrix3::identity();
    matrix[(0, 1)] = f64::NAN;
    assert!(matches!(
        covariance_from_information(&matrix),
        Err(CovarianceError::NotFinite { row: 0, column: 1, .. })
    ));
    let mut matrix = Matrix3::identity();
    matrix[(1, 2)] = 0.5;
    assert!(matches!(
        covariance_from_information(&matrix),
        Err(CovarianceError::NotSymmetric { row: 1, column: 2, difference: 0.5 })
    ));
    let singular = Vector3::new(1.0, 2.0, 3.0) * Vector3::new(1.0, 2.0, 3.0).transpose();
    assert_eq!(covariance_from_information(&singular), Err(CovarianceError::Singular { index: 1 }));
    assert_eq!(covariance_from_information(&Matrix3::zeros()), Err(CovarianceError::Singular { index: 0 }));
    let indefinite = Matrix2::new(1.0, 2.0, 2.0, 1.0);
    let error = information_from_covariance(&indefinite).unwrap_err();
    assert_eq!(error, CovarianceError::NotPositiveDefinite { index: 1, pivot: -3.0 });
    assert!(error.to_string().contains("eliminating the components before 1 leaves -3e0"), "{error}");
    assert!(information_from_covariance(&Matrix2::new(-1.0, 0.0, 0.0, 1.0)).is_err());
}

#[test]
fn definiteness_forgives_printed_digits_and_nothing_more() {
    assert_eq!(definiteness(&Matrix3::identity()), Definiteness::PositiveDefinite);
    let diagonal = |last: f64| Matrix3::from_diagonal(&Vector3::new(2.0, 1.0, last));
    assert_eq!(definiteness(&diagonal(2.1e-9)), Definiteness::PositiveDefinite);
    assert!(matches!(definiteness(&diagonal(1.9e-9)), Definiteness::Semidefinite { .. }));
    assert!(matches!(definiteness(&diagonal(0.0)), Definiteness::Semidefinite { .. }));
    assert!(matches!(definiteness(&diagonal(-1.9e-9)), Definiteness::Semidefinite { .. }));
    assert_eq!(
        definiteness(&diagonal(-2.1e-9)),
        Definiteness::Indefinite { smallest: -2.1e-9, largest: 2.0 }
    );
    assert!(matches!(definiteness(&Matrix3::zeros()), Definiteness::Semidefinite { .. }));
    assert!(matches!(definiteness(&-Matrix3::identity()), Definiteness::Indefinite { .. }));
    assert_eq!(definiteness(&diagonal(f64::NAN)), Definiteness::NotFinite);
    assert!(matches!(definiteness(&(Matrix3::identity() * 1e308)), Definiteness::PositiveDefinite));
}

#[test]
fn a_list_of_the_wrong_length_is_refused() {
    let error = unpack_upper_triangle::<3>(&[1.0; 5]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "5 terms cannot fill the upper triangle of a 3 x 3 matrix: write its 6 terms row by row"
    );
}

//! What of a covariance is translation with the right heading.
//!
//! A measurement may be wrong in translation alone, as along a corridor, or in rotation, which moves what is far away. Its covariance S of
//! translation and rotation is the sum of that of the translation given the rotation, T - C R^-1 C^T, and of what comes with the rotation.

use nalgebra::SMatrix;
use posecut_geometry::translations;
use posecut_pcm::candidate::Candidate;
use posecut_pcm::chain::Chain;

use crate::model::Motion;

/// The part of a candidate's covariance that is translation with the right heading, in the frame of chain B.
pub(crate) fn translation_of<G: Motion<DOF>, const DOF: usize>(
    candidate: &Candidate<G, DOF>,
    chain: &Chain<G, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    let there = chain.poses[candidate.k].adjoint();
    let back = chain.poses[candidate.k].inverse().adjoint();
    there * translation_part(&(back * candidate.covariance * back.transpose())) * there.transpose()
}

/// The part of the covariance of a pose that is translation with the right heading: that of the translation given the rotation. Zero where
/// the rotation has no definite covariance.
pub(crate) fn translation_part<const DOF: usize>(
    covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    let mut part = *covariance;
    // Schur's complement, one axis of rotation at a time.
    for axis in translations(DOF)..DOF {
        let pivot = part[(axis, axis)];
        if !(pivot > 0.0) {
            return SMatrix::zeros();
        }
        let column = part.column(axis).into_owned();
        part -= column * column.transpose() / pivot;
        part.row_mut(axis).fill(0.0);
        part.column_mut(axis).fill(0.0);
    }
    part
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;
    use posecut_geometry::{LieGroup, SE2};
    use proptest::prelude::*;

    use super::*;

    fn covariance(numbers: [f64; 9]) -> Matrix3<f64> {
        let root = Matrix3::from_row_slice(&numbers);
        root * root.transpose() + Matrix3::identity() * 0.01
    }

    fn least_eigenvalue(matrix: &Matrix3<f64>) -> f64 {
        matrix.symmetric_eigenvalues().min()
    }

    proptest! {
        #[test]
        fn both_parts_are_covariances_and_the_first_has_no_rotation(numbers in prop::array::uniform9(-1.0..1.0)) {
            let whole = covariance(numbers);
            let part = translation_part(&whole);
            prop_assert_eq!(part.row(2).amax(), 0.0);
            prop_assert!(least_eigenvalue(&part) >= -1e-12);
            prop_assert!(least_eigenvalue(&(whole - part)) >= -1e-12);
        }

        #[test]
        fn noise_of_translation_and_a_turn_elsewhere_come_apart(
            along in 0.01..2.0, across in 0.01..2.0, turn in 0.001..1.0, x in -50.0..50.0, y in -50.0..50.0,
        ) {
            // A rotation about a point far away moves the frame; the translation that comes with it is none of its own.
            let own = Matrix3::from_diagonal(&[along, across, 0.0].into());
            let lever = SE2::new(x, y, 0.0).adjoint();
            let turned = lever * Matrix3::from_diagonal(&[0.0, 0.0, turn].into()) * lever.transpose();
            let part = translation_part(&(own + turned));
            prop_assert!((part - own).amax() < 1e-9 * (1.0 + turned.amax()));
        }
    }

    #[test]
    fn without_a_covariance_of_the_rotation_there_is_no_such_part() {
        assert_eq!(translation_part(&Matrix3::from_diagonal(&[1.0, 1.0, 0.0].into())), Matrix3::zeros());
        assert_eq!(translation_part(&Matrix3::from_diagonal(&[1.0, 1.0, f64::NAN].into())), Matrix3::zeros());
    }
}

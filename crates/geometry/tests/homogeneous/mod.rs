//! Poses as homogeneous matrices, and an exponential that shares no formula with the crate.

use nalgebra::{DMatrix, Vector3, Vector6};
use posecut_geometry::{SE2, SE3};

/// The matrix form of a group and of its algebra.
pub(crate) trait Homogeneous<Tangent> {
    /// `[R, t; 0, 1]`.
    fn homogeneous(&self) -> DMatrix<f64>;
    /// `[hat(rotation), translation; 0, 0]`.
    fn algebra(tangent: &Tangent) -> DMatrix<f64>;
}

impl Homogeneous<Vector3<f64>> for SE2 {
    fn homogeneous(&self) -> DMatrix<f64> {
        let (s, c) = (self.rotation.im, self.rotation.re);
        let t = self.translation;
        DMatrix::from_row_slice(3, 3, &[c, -s, t.x, s, c, t.y, 0.0, 0.0, 1.0])
    }

    fn algebra(t: &Vector3<f64>) -> DMatrix<f64> {
        DMatrix::from_row_slice(3, 3, &[0.0, -t.z, t.x, t.z, 0.0, t.y, 0.0, 0.0, 0.0])
    }
}

impl Homogeneous<Vector6<f64>> for SE3 {
    fn homogeneous(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::identity(4, 4);
        let rotation = self.rotation.to_rotation_matrix();
        for row in 0..3 {
            for column in 0..3 {
                matrix[(row, column)] = rotation[(row, column)];
            }
            matrix[(row, 3)] = self.translation[row];
        }
        matrix
    }

    fn algebra(t: &Vector6<f64>) -> DMatrix<f64> {
        #[rustfmt::skip]
        let entries = [
            0.0, -t[5], t[4], t[0],
            t[5], 0.0, -t[3], t[1],
            -t[4], t[3], 0.0, t[2],
            0.0, 0.0, 0.0, 0.0,
        ];
        DMatrix::from_row_slice(4, 4, &entries)
    }
}

/// `exp(A)` by its power series after halving `A` ten times, then squaring back.
pub(crate) fn matrix_exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let halvings = 10;
    let scaled = matrix / f64::from(1 << halvings);
    let size = matrix.nrows();
    // exp(A) - I is squared as 2 B + B^2, which keeps digits that I + B would lose.
    let mut term = scaled.clone();
    let mut sum = scaled.clone();
    for order in 2..20 {
        term = &term * &scaled / f64::from(order);
        sum += &term;
    }
    for _ in 0..halvings {
        sum = &sum * 2.0 + &sum * &sum;
    }
    sum + DMatrix::identity(size, size)
}

//! How well a match is determined.
//!
//! ICP minimises `sum r^2` with the residuals `r = n . (T p - q)` of points `p` of the query and `q` of the reference. With the
//! Jacobian rows `j = dr / dxi` (`T Exp(xi)`) and `H = sum j^T j`, an error of the points moves the minimum by
//! `-H^-1 sum j^T dr`. The points `p` err independently, but a point `q` that several points were matched with errs once for all of
//! them. The covariance of the match is therefore `H^-1 M H^-1` with
//!
//! ```text
//! M = sigma^2 / 2 (sum_p j^T j + sum_q (sum_{p at q} j)^T (sum_{p at q} j))
//! ```
//!
//! where `sigma^2` is the variance of a residual, half of it from `p` and half from `q`.
//! This is Censi's formula (*An accurate closed-form estimate of ICP's covariance*, ICRA 2007, equation 4) for point-to-line
//! residuals with the normals held fixed. Its inverse `H M^-1 H` exists along a corridor, too. There the noise of normals gives `H` a
//! small eigenvalue, which is no information: [`determined`] removes it.

use nalgebra::{Matrix3, RowVector3, SymmetricEigen, U3};

/// A residual's row of the Jacobian, with the reference point that it was matched with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) jacobian: RowVector3<f64>,
    pub(crate) reference: usize,
    pub(crate) weight: f64,
}

/// Directions whose eigenvalue of the Hessian is below this share of the number of points are undetermined. Normals that err by 2 degrees
/// give a share of 0.0012.
const DETERMINED: f64 = 2e-3;

/// The Hessian of so many points, with a zero for the eigenvalue of each direction that they do not determine.
pub(crate) fn determined(hessian: Matrix3<f64>, points: usize) -> SymmetricEigen<f64, U3> {
    let mut eigen = hessian.symmetric_eigen();
    let least = DETERMINED * points as f64;
    eigen.eigenvalues.apply(|value| *value = if *value > least { *value } else { 0.0 });
    eigen
}

/// The information matrix of a match, in the order x, y, theta: `H M^-1 H`, zero in directions that the points do not determine. The
/// deviation is that of a residual, metres. Beside the noise of the points, the match has at least the covariance `floor` (diagonal,
/// m^2 and rad^2), for what the points have in common. O(n log n).
pub(crate) fn information(rows: &mut [Row], deviation: f64, floor: [f64; 3]) -> Matrix3<f64> {
    rows.sort_by_key(|row| row.reference);
    let mut hessian = Matrix3::zeros();
    let mut spread = Matrix3::zeros();
    for group in rows.chunk_by(|one, other| one.reference == other.reference) {
        let mut sum = RowVector3::zeros();
        for row in group {
            let weighted = row.jacobian * row.weight;
            hessian += row.jacobian.transpose() * weighted;
            spread += weighted.transpose() * weighted;
            sum += weighted;
        }
        spread += sum.transpose() * sum;
    }
    spread *= 0.5 * deviation * deviation;
    let hessian = determined(hessian, rows.len()).recompose();
    // The floor as a covariance of the minimum, `H^-1 M H^-1 + F`, is `M + H F H` in the middle.
    spread += hessian * Matrix3::from_diagonal(&floor.into()) * hessian;
    // Directions that nothing determines: the middle must stay invertible, and their information be zero.
    let ridge = 1e-12 * spread.trace().max(f64::MIN_POSITIVE);
    let Some(inverse) = (spread + Matrix3::identity() * ridge).try_inverse() else { return Matrix3::zeros() };
    let information = hessian * inverse * hessian;
    (information + information.transpose()) * 0.5
}

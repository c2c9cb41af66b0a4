//! Rotations first, by the chordal relaxation, then translations; both by linear least squares.
//!
//! L. Carlone, R. Tron, K. Daniilidis, F. Dellaert, "Initialization techniques for 3D SLAM: a survey on rotation
//! estimation and its use in pose graph optimization", ICRA 2015, section III.B; rotations alone go back to Martinec and
//! Pajdla, 2007.

use nalgebra::{Complex, Matrix2, Matrix3, Rotation3, SMatrix, SVector, UnitComplex, UnitQuaternion};
use posecut_geometry::{LieGroup, SE2, SE3};

use crate::model::problem::Edge;
use crate::normal_equations::{NormalEquations, Pattern};
use posecut_cholesky::Factor;

/// A pose as rotation matrix and translation in `N` dimensions.
pub(crate) trait MatrixPose<const N: usize>: Sized {
    fn rotation_matrix(&self) -> SMatrix<f64, N, N>;
    fn translation_vector(&self) -> SVector<f64, N>;
    /// The nearest rotation to a matrix in the Frobenius norm.
    fn nearest_rotation(matrix: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N>;
    fn from_matrix(rotation: &SMatrix<f64, N, N>, translation: &SVector<f64, N>) -> Self;
}

impl MatrixPose<2> for SE2 {
    fn rotation_matrix(&self) -> Matrix2<f64> {
        self.rotation.to_rotation_matrix().into_inner()
    }

    fn translation_vector(&self) -> SVector<f64, 2> {
        self.translation
    }

    fn nearest_rotation(matrix: &Matrix2<f64>) -> Matrix2<f64> {
        let sum = Complex::new(matrix.m11 + matrix.m22, matrix.m21 - matrix.m12);
        let norm = sum.re.hypot(sum.im);
        // Every rotation is as near to a multiple of a reflection.
        let turn = if norm == 0.0 { Complex::new(1.0, 0.0) } else { sum / norm };
        Matrix2::new(turn.re, -turn.im, turn.im, turn.re)
    }

    fn from_matrix(rotation: &Matrix2<f64>, translation: &SVector<f64, 2>) -> Self {
        let rotation = UnitComplex::new_unchecked(Complex::new(rotation.m11, rotation.m21));
        SE2 { translation: *translation, rotation }
    }
}

impl MatrixPose<3> for SE3 {
    fn rotation_matrix(&self) -> Matrix3<f64> {
        self.rotation.to_rotation_matrix().into_inner()
    }

    fn translation_vector(&self) -> SVector<f64, 3> {
        self.translation
    }

    fn nearest_rotation(matrix: &Matrix3<f64>) -> Matrix3<f64> {
        if let Some(rotation) = polar_factor(matrix) {
            return rotation;
        }
        let svd = matrix.svd(true, true);
        let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Matrix3::identity() };
        let sign = (u * v_t).determinant().signum();
        // If the product is a reflection, the column of the smallest singular value changes its sign.
        let smallest = svd.singular_values.imin();
        let mut corrected = u;
        corrected.column_mut(smallest).scale_mut(sign);
        corrected * v_t
    }

    fn from_matrix(rotation: &Matrix3<f64>, translation: &SVector<f64, 3>) -> Self {
        SE3::new(
            *translation,
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation)),
        )
    }
}

/// The orthogonal factor of a matrix with positive determinant that is far from singular, by Newton's iteration
/// `Y <- (Y + Y^-T) / 2`: many times faster than singular values. N. J. Higham, "Computing the polar decomposition", 1986.
fn polar_factor(matrix: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let scale = matrix.norm() / 3.0_f64.sqrt();
    let mut rotation = matrix / scale;
    for _ in 0..16 {
        let [x, y, z] = [0, 1, 2].map(|column| rotation.column(column).into_owned());
        let cofactors = Matrix3::from_columns(&[y.cross(&z), z.cross(&x), x.cross(&y)]);
        let determinant = x.dot(&y.cross(&z));
        if !(determinant > 1e-2) {
            return None;
        }
        let next = (rotation + cofactors / determinant) * 0.5;
        let change = (next - rotation).amax();
        rotation = next;
        if change < 1e-9 {
            // Convergence is quadratic: the remaining error is below rounding.
            return Some(rotation);
        }
    }
    None
}

/// Poses of a connected graph whose first poses are given in `held`; `None` if a linear system is singular. If none is held,
/// `anchor` is the pose of the first node.
pub(crate) fn poses<G, const DOF: usize, const N: usize>(
    pattern: &Pattern,
    edges: &[Edge<G, DOF>],
    held: &[G],
    anchor: &G,
    factor: &mut Factor<N>,
) -> Option<Vec<G>>
where
    G: LieGroup<DOF> + MatrixPose<N>,
{
    let mut equations = NormalEquations::<N>::new(pattern);
    let rotations = rotations::<G, DOF, N>(pattern, edges, held, anchor, &mut equations, factor)?;
    let translations =
        translations::<G, DOF, N>(pattern, edges, held, anchor, &rotations, &mut equations, factor)?;
    let mut poses: Vec<G> = rotations
        .iter()
        .zip(&translations)
        .map(|(rotation, translation)| G::from_matrix(rotation, translation))
        .collect();
    // A conversion to a matrix and back would change the last bits.
    poses[..held.len()].copy_from_slice(held);
    Some(poses)
}

/// Minimises `sum kappa |R_i Z_ij - R_j|^2` (Frobenius) over matrices, row by row, and rounds each to a rotation: equation
/// (20) of the survey. `kappa` is the mean information of the rotation's axes.
fn rotations<G, const DOF: usize, const N: usize>(
    pattern: &Pattern,
    edges: &[Edge<G, DOF>],
    held: &[G],
    anchor: &G,
    equations: &mut NormalEquations<N>,
    factor: &mut Factor<N>,
) -> Option<Vec<SMatrix<f64, N, N>>>
where
    G: LieGroup<DOF> + MatrixPose<N>,
{
    let mut result = Vec::with_capacity(held.len() + pattern.variables);
    result.extend(held.iter().map(MatrixPose::rotation_matrix));
    let mut rows: [Vec<SVector<f64, N>>; N] =
        std::array::from_fn(|_| vec![SVector::zeros(); pattern.variables]);
    equations.clear();
    for (edge, slot) in edges.iter().zip(&pattern.slots) {
        let kappa = (N..DOF).map(|axis| edge.information[(axis, axis)]).sum::<f64>() / (DOF - N) as f64;
        let measured = edge.measurement.rotation_matrix() * kappa;
        for node in [slot.from, slot.to].into_iter().flatten() {
            equations.diagonal[node] += SMatrix::<f64, N, N>::identity() * kappa;
        }
        equations.add_off_diagonal(slot, &-measured);
        // Terms of held nodes move to the right-hand side.
        match (slot.from, slot.to) {
            (None, Some(to)) => {
                for (row, right) in rows.iter_mut().enumerate() {
                    right[to] += measured.tr_mul(&result[edge.from].row(row).transpose());
                }
            }
            (Some(from), None) => {
                for (row, right) in rows.iter_mut().enumerate() {
                    right[from] += measured * result[edge.to].row(row).transpose();
                }
            }
            _ => {}
        }
    }
    if held.is_empty() {
        // Any weight gives the same minimum up to a rotation of all nodes: the edges do not resist one.
        let weight = equations.diagonal[0][(0, 0)];
        equations.diagonal[0] += SMatrix::<f64, N, N>::identity() * weight;
        for (row, right) in rows.iter_mut().enumerate() {
            right[0] += anchor.rotation_matrix().row(row).transpose() * weight;
        }
    }
    factor.factorize(&pattern.symbolic, &equations.diagonal, &equations.off_diagonal, 0.0, [0.0; N]).ok()?;
    if let [first, second] = rows.as_mut_slice() {
        // Rotations of the plane commute, so the second row is the first one turned by a right angle.
        factor.solve(&pattern.symbolic, first);
        for (turned, row) in second.iter_mut().zip(first.iter()) {
            turned[0] = -row[1];
            turned[1] = row[0];
        }
    } else {
        for right in &mut rows {
            factor.solve(&pattern.symbolic, right);
        }
    }
    let matrices = (0..pattern.variables)
        .map(|variable| SMatrix::<f64, N, N>::from_fn(|row, column| rows[row][variable][column]));
    for matrix in matrices {
        if matrix.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        result.push(G::nearest_rotation(&matrix));
    }
    Some(result)
}

/// Minimises `sum |R_i^T (t_j - t_i) - z_ij|^2`, weighted by the information of the translation, for fixed rotations.
fn translations<G, const DOF: usize, const N: usize>(
    pattern: &Pattern,
    edges: &[Edge<G, DOF>],
    held: &[G],
    anchor: &G,
    rotations: &[SMatrix<f64, N, N>],
    equations: &mut NormalEquations<N>,
    factor: &mut Factor<N>,
) -> Option<Vec<SVector<f64, N>>>
where
    G: LieGroup<DOF> + MatrixPose<N>,
{
    equations.clear();
    let mut right = vec![SVector::<f64, N>::zeros(); pattern.variables];
    for (edge, slot) in edges.iter().zip(&pattern.slots) {
        let rotation = &rotations[edge.from];
        let information = edge.information.fixed_view::<N, N>(0, 0);
        let weight = rotation * information * rotation.transpose();
        let pull = weight * (rotation * edge.measurement.translation_vector());
        if let Some(to) = slot.to {
            equations.diagonal[to] += weight;
            right[to] += pull;
            if slot.from.is_none() {
                right[to] += weight * held[edge.from].translation_vector();
            }
        }
        if let Some(from) = slot.from {
            equations.diagonal[from] += weight;
            right[from] -= pull;
            if slot.to.is_none() {
                right[from] += weight * held[edge.to].translation_vector();
            }
        }
        equations.add_off_diagonal(slot, &-weight);
    }
    if held.is_empty() {
        let weight = equations.diagonal[0].trace();
        equations.diagonal[0] += SMatrix::<f64, N, N>::identity() * weight;
        right[0] += anchor.translation_vector() * weight;
    }
    factor.factorize(&pattern.symbolic, &equations.diagonal, &equations.off_diagonal, 0.0, [0.0; N]).ok()?;
    factor.solve(&pattern.symbolic, &mut right);
    right.splice(0..0, held.iter().map(MatrixPose::translation_vector));
    right.iter().all(|translation| translation.iter().all(|value| value.is_finite())).then_some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_rotation_is_that_of_the_singular_values() {
        let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.5).into_inner();
        let stretch = Matrix3::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 0.4);
        let near = <SE3 as MatrixPose<3>>::nearest_rotation(&(turn * stretch * 0.1));
        assert!((near - turn).amax() < 1e-14 && polar_factor(&(turn * stretch)).is_some(), "{near} {turn}");
        // The rotation nearest to a reflection differs from it in the direction of the smallest singular value.
        let mirrored = turn * Matrix3::from_diagonal(&nalgebra::Vector3::new(3.0, 2.0, -1.0));
        let near = <SE3 as MatrixPose<3>>::nearest_rotation(&mirrored);
        assert!(polar_factor(&mirrored).is_none() && (near - turn).amax() < 1e-14, "{near} {turn}");
    }
}

//! SE-Sync's cost: `F = sum of kappa |R_j - R_i Z_R|^2 + tau |t_j - t_i - R_i Z_t|^2` (Frobenius), isotropic weights.
//!
//! D. M. Rosen, L. Carlone, A. S. Bandeira, J. J. Leonard, "SE-Sync: a certifiably correct algorithm for synchronization
//! over the special Euclidean group", IJRR 38(2-3), 2019, problem 1.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;

use crate::initialisation::chordal::MatrixPose;
use crate::model::problem::Edge;
use crate::model::quadratic::Linearised;
use crate::model::term::Term;

/// An edge of `F`.
pub(crate) struct ChordalEdge<const N: usize> {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) rotation: SMatrix<f64, N, N>,
    pub(crate) translation: SVector<f64, N>,
    /// Weight of the rotation.
    pub(crate) kappa: f64,
    /// Weight of the translation.
    pub(crate) tau: f64,
}

impl<const N: usize> ChordalEdge<N> {
    /// Weights as in SE-Sync's reader: `tau = N / tr(I_tt^-1)`; `kappa = I_rr` in the plane and `3 / (2 tr(I_rr^-1))` in
    /// space. `None` if a block of the information has no inverse.
    pub(crate) fn new<G: MatrixPose<N>, const DOF: usize>(edge: &Edge<G, DOF>) -> Option<Self> {
        let inverse_trace = |start: usize, size: usize| {
            let block = edge.information.view((start, start), (size, size)).clone_owned();
            let trace = block.cholesky()?.inverse().trace();
            (trace > 0.0 && trace.is_finite()).then_some(trace)
        };
        let tau = N as f64 / inverse_trace(0, N)?;
        let trace = inverse_trace(N, DOF - N)?;
        let kappa = if N == 2 { 1.0 / trace } else { 1.5 / trace };
        Some(Self {
            from: edge.from,
            to: edge.to,
            rotation: edge.measurement.rotation_matrix(),
            translation: edge.measurement.translation_vector(),
            kappa,
            tau,
        })
    }
}

impl<G: LieGroup<DOF> + MatrixPose<N>, const DOF: usize, const N: usize> Term<G, DOF> for ChordalEdge<N> {
    fn cost(&self, poses: &[G]) -> f64 {
        let relative = poses[self.from].between(&poses[self.to]);
        let turn = (relative.rotation_matrix() - self.rotation).norm_squared();
        self.kappa * turn + self.tau * (relative.translation_vector() - self.translation).norm_squared()
    }

    /// In a right perturbation `(rho, delta)` of `X_ij`, with `D = Z_R^T R_ij`: half the gradient is
    /// `tau R_ij^T (t_ij - Z_t)` and `kappa vee(D - D^T)`; the Gauss-Newton matrix is `diag(tau I, 2 kappa I)`.
    fn linearise(&self, poses: &[G]) -> Linearised<DOF> {
        let relative = poses[self.from].between(&poses[self.to]);
        let rotation = relative.rotation_matrix();
        let difference = self.rotation.tr_mul(&rotation);
        let pull = rotation.tr_mul(&(relative.translation_vector() - self.translation)) * self.tau;
        let axes: &[(usize, usize)] = if N == 2 { &[(1, 0)] } else { &[(2, 1), (0, 2), (1, 0)] };
        let mut to_to = SMatrix::<f64, DOF, DOF>::zeros();
        let mut to_gradient = SVector::<f64, DOF>::zeros();
        for axis in 0..N {
            to_to[(axis, axis)] = self.tau;
            to_gradient[axis] = pull[axis];
        }
        for (axis, &(row, column)) in axes.iter().enumerate() {
            to_to[(N + axis, N + axis)] = 2.0 * self.kappa;
            to_gradient[N + axis] = self.kappa * (difference[(row, column)] - difference[(column, row)]);
        }
        Linearised::new(&relative, to_to, to_gradient, Term::<G, DOF>::cost(self, poses))
    }
}

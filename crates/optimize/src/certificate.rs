//! Whether a solution is provably global, by SE-Sync's dual certificate.
//!
//! The cost `F` of `chordal_cost` is `tr(X M X^T)` with `X = [t R]`. Let `Lambda` be block-diagonal with
//! `Lambda_i = sym(R_i^T (X M)_i)`. For every feasible `X'`, `F(X') >= sum of tr(Lambda_i) + d n min(lambda, 0)`, where
//! `lambda` is the least eigenvalue of `S = Q - Lambda` and `Q` is `M` with the translations eliminated (theorem 7 there).
//! `S + eta I` is positive definite if and only if `M - Lambda + eta I` (on the rotations alone, one translation held) is:
//! one sparse Cholesky factorisation decides.
//!
//! D. M. Rosen, L. Carlone, A. S. Bandeira, J. J. Leonard, "SE-Sync", IJRR 38(2-3), 2019.
//!
//! Depends on the model, on `normal_equations`, and on `descent`, which refines poses for `F` first.

pub(crate) mod chordal_cost;
pub(crate) mod chordal_matrix;

use nalgebra::{SMatrix, SVector};

use crate::descent::workspace::Workspace;
use crate::initialisation::chordal::MatrixPose;
use crate::model::lanes::LaneGroup;
use crate::model::magnitude::Magnitude;
use crate::model::problem::Edge;
use crate::normal_equations::Pattern;
use crate::options::Options;
use chordal_cost::ChordalEdge;
use chordal_matrix::ChordalMatrix;
use posecut_cholesky::{Factor, Memory};

/// The matrix is raised by this share of the cost, spread over all rotations, before its sign is tested.
const GAP: f64 = 1e-6;
/// The verdict is 'global' if the bound is below the cost by at most this share of it: more than [`GAP`], where rounding is large.
const PROVEN: f64 = 1e-3;
/// An eigenvalue below this share of the largest diagonal entry of the rotations is rounding.
const ROUNDING: f64 = 1e-12;
/// Inverse iterations for the reported eigenvalue; the verdict does not depend on them.
const ITERATIONS: usize = 60;

/// The certificate of a connected component.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// No poses have an `F` lower than that of the refined ones by more than a thousandth, and the eigenvalue is not negative.
    pub global: bool,
    /// `F` after refinement from the given poses.
    pub cost: f64,
    /// No poses have an `F` below this; minus infinity if nothing is known.
    pub lower_bound: f64,
    /// Least eigenvalue of the certificate matrix `S`, an estimate from above.
    pub eigenvalue: f64,
    /// Eigenvalues above the negative of this count as not negative.
    pub tolerance: f64,
}

impl Certificate {
    /// The certificate if nothing is known.
    pub(crate) const NONE: Self = Self {
        global: false,
        cost: f64::NAN,
        lower_bound: f64::NEG_INFINITY,
        eigenvalue: f64::NAN,
        tolerance: f64::NAN,
    };
}

/// Refines the poses of a connected graph for `F` and certifies them; also returns the refined poses. `M` is `N + 1`.
pub(crate) fn certify<G, const DOF: usize, const N: usize, const M: usize>(
    edges: &[Edge<G, DOF>],
    poses: &[G],
) -> (Certificate, Vec<G>)
where
    G: LaneGroup<DOF> + MatrixPose<N>,
{
    let Some(terms) = edges.iter().map(ChordalEdge::<N>::new::<G, DOF>).collect::<Option<Vec<_>>>() else {
        return (Certificate::NONE, poses.to_vec());
    };
    let mut poses = poses.to_vec();
    let pattern = Pattern::of(poses.len(), 1, edges);
    // By the gradient, until steps no longer shrink: errors of the poses enter the multipliers at first order, the cost at second.
    let refine = Options { cost_tolerance: 0.0, max_iterations: 500, ..Options::default() };
    let magnitude = Magnitude::of(edges.iter());
    let outcome =
        Workspace::new(&pattern, magnitude, Memory::default()).minimise(&terms, &mut poses, &refine);
    let (matrix, trace) = subtract_multipliers::<G, DOF, N, M>(&terms, &poses);
    let size = (N * poses.len()) as f64;
    // Without noise the cost itself is rounding.
    let rounding = 10.0 * magnitude.noiseless();
    let tolerance = (GAP * outcome.cost / size).max(ROUNDING * matrix.largest());
    // Shifts by the tolerance, then by ten times more each time, until the matrix is positive definite.
    let mut factor = Factor::<M>::new(&matrix.symbolic);
    let mut shift = tolerance;
    while !matrix.factorize(&mut factor, shift) {
        shift *= 10.0;
        if !shift.is_finite() {
            return (Certificate { cost: outcome.cost, tolerance, ..Certificate::NONE }, poses);
        }
    }
    // `S + shift I` is positive definite, so `lambda > -shift`: this gives the lower bound.
    let lower_bound = trace - size * shift;
    let certificate = Certificate {
        // Where rounding makes the tolerance large, the bound may be far below the cost: then nothing is proved.
        global: shift <= tolerance && outcome.cost - lower_bound <= PROVEN * outcome.cost + rounding,
        cost: outcome.cost,
        lower_bound,
        eigenvalue: least_eigenvalue(&matrix, &mut factor, shift),
        tolerance,
    };
    (certificate, poses)
}

/// `M - Lambda`, and the sum of `tr(Lambda_i)`.
fn subtract_multipliers<G, const DOF: usize, const N: usize, const M: usize>(
    terms: &[ChordalEdge<N>],
    poses: &[G],
) -> (ChordalMatrix<M>, f64)
where
    G: LaneGroup<DOF> + MatrixPose<N>,
{
    // Lambda before symmetrisation.
    let mut multipliers = vec![SMatrix::<f64, N, N>::zeros(); poses.len()];
    let identity = SMatrix::<f64, N, N>::identity();
    for term in terms {
        let (kappa, tau, z) = (term.kappa, term.tau, &term.translation);
        let (from, to) = (&poses[term.from], &poses[term.to]);
        let (turn, turned) = (from.rotation_matrix(), to.rotation_matrix());
        let error = to.translation_vector() - from.translation_vector() - turn * z;
        multipliers[term.from] += identity * kappa
            - turn.tr_mul(&turned) * term.rotation.transpose() * kappa
            - turn.tr_mul(&error) * z.transpose() * tau;
        multipliers[term.to] += identity * kappa - turned.tr_mul(&turn) * term.rotation * kappa;
    }
    let mut matrix = ChordalMatrix::<M>::new::<N>(poses.len(), terms);
    let mut trace = 0.0;
    for (block, multiplier) in matrix.diagonal.iter_mut().zip(&multipliers) {
        trace += multiplier.trace();
        for row in 0..N {
            for column in 0..N {
                let half = multiplier[(row, column)] + multiplier[(column, row)];
                block[(row + 1, column + 1)] -= 0.5 * half;
            }
        }
    }
    (matrix, trace)
}

/// Inverse iteration on `S + shift I`: the rotations' part of the inverse is the inverse of the Schur complement.
fn least_eigenvalue<const M: usize>(matrix: &ChordalMatrix<M>, factor: &mut Factor<M>, shift: f64) -> f64 {
    let mut vector: Vec<SVector<f64, M>> = (0..matrix.diagonal.len())
        .map(|node| SVector::from_fn(|row, _| ((node * M + row) as f64 * 1.618_034).sin()))
        .collect();
    let mut eigenvalue = f64::NAN;
    for _ in 0..ITERATIONS {
        for block in &mut vector {
            block[0] = 0.0;
        }
        let norm = vector.iter().map(SVector::norm_squared).sum::<f64>().sqrt();
        for block in &mut vector {
            *block /= norm;
        }
        let before = vector.clone();
        factor.solve(&matrix.symbolic, &mut vector);
        let quotient: f64 = before.iter().zip(&vector).map(|(a, b)| a.dot(b)).sum();
        eigenvalue = 1.0 / quotient - shift;
    }
    eigenvalue
}

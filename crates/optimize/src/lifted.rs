//! A start from the chordal cost in more dimensions, where it has fewer local minima.
//!
//! SE-Sync's cost `F` (`certificate::chordal_cost`) is `tr(X M X^T)` with `X = [t R]`. Rotations in the plane are columns of length one at
//! right angles; this module lets them be such columns in two dimensions more, minimises `F` there, and projects the result back. A pose
//! that is turned the wrong way round can leave the plane, turn, and come back, so that most local minima vanish (N. Boumal, V. Voroninski,
//! A. S. Bandeira, "The non-convex Burer-Monteiro approach works on smooth semidefinite programs", 2016; D. M. Rosen, L. Carlone,
//! A. S. Bandeira, J. J. Leonard, "SE-Sync", IJRR 38(2-3), 2019, algorithms 1 and 2).
//!
//! [`matrix`] has the products with `M`, [`manifold`] the columns, [`places`] the translations, [`tangent`] the matrix on tangents,
//! [`preconditioner`] the choice between the two matrices, [`trust_region`] the iteration, and [`projection`] the way back. Depends on
//! `certificate` for `F` and `M`, on [`initialisation`](crate::initialisation) for rotations as matrices, and on posecut-cholesky.

mod manifold;
mod matrix;
mod places;
mod preconditioner;
mod projection;
mod tangent;
mod trust_region;

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::certificate::chordal_cost::ChordalEdge;
use crate::certificate::chordal_matrix::ChordalMatrix;
use crate::effort::Effort;
use crate::initialisation::chordal::MatrixPose;
use crate::model::problem::Edge;
use manifold::orthonormalise;

/// Seed of the added entries: the result depends on the graph alone.
const SEED: u64 = 1;

/// Poses of a connected graph near the minimum of `F` in `P` dimensions, found from these poses: one projection if the relaxation is tight,
/// and several otherwise; `None` if `F` does not exist or its matrix is singular. The first pose stays the same. `N` is the dimension, `M` is
/// `N + 1`, and a pose has `T` tangents: `P + N (N - 1) / 2 + (P - N) N`.
pub(crate) fn lifted_poses<
    G,
    const DOF: usize,
    const N: usize,
    const M: usize,
    const P: usize,
    const T: usize,
>(
    edges: &[Edge<G, DOF>],
    poses: &[G],
    effort: &mut Effort,
) -> Option<Vec<Vec<G>>>
where
    G: LieGroup<DOF> + MatrixPose<N>,
{
    let terms: Vec<_> = edges.iter().map(ChordalEdge::<N>::new::<G, DOF>).collect::<Option<_>>()?;
    let matrix = ChordalMatrix::<M>::new::<N>(poses.len(), &terms);
    let origin = poses.first()?;
    // The translation of the first node is zero: `M` does not change if all move.
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let start = poses.iter().map(|pose| {
        let translation = pose.translation_vector() - origin.translation_vector();
        raise::<N, M, P>(&pose.rotation_matrix(), &translation, &mut random)
    });
    let lifted = trust_region::minimise::<N, M, P, T>(&matrix, start.collect(), effort)?;
    let spaces = projection::spaces::<N, M, P>(&lifted, &mut random);
    spaces.iter().map(|space| returned(&projection::project_to(&lifted, space), origin)).collect()
}

/// The poses nearest to these blocks, moved so that the first is the origin.
fn returned<G, const DOF: usize, const N: usize, const M: usize>(
    flat: &[SMatrix<f64, N, M>],
    origin: &G,
) -> Option<Vec<G>>
where
    G: LieGroup<DOF> + MatrixPose<N>,
{
    let turned = flat.iter().map(|block| {
        let rotation = G::nearest_rotation(&block.fixed_columns::<N>(1).into_owned());
        G::from_matrix(&rotation, &block.column(0).into_owned())
    });
    let turned: Vec<G> = turned.collect();
    let first = turned.first()?;
    let mut moved: Vec<G> = turned.iter().map(|pose| origin.compose(&first.between(pose))).collect();
    moved[0] = *origin;
    Some(moved)
}

/// A pose in `P` dimensions. In the added ones its axes have random entries up to 1: from the original space alone, the gradient would never
/// lead out.
fn raise<const N: usize, const M: usize, const P: usize>(
    rotation: &SMatrix<f64, N, N>,
    translation: &SVector<f64, N>,
    random: &mut ChaCha8Rng,
) -> SMatrix<f64, P, M> {
    let mut block = SMatrix::<f64, P, M>::zeros();
    block.fixed_view_mut::<N, 1>(0, 0).copy_from(translation);
    block.fixed_view_mut::<N, N>(0, 1).copy_from(rotation);
    for row in N..P {
        for column in 1..M {
            block[(row, column)] = random.random_range(-1.0..1.0);
        }
    }
    orthonormalise(block)
}

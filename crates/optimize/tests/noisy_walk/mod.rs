//! A noisy walk with landmark edges.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_optimize::{Edge, EdgeKind, PoseGroup};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// True poses, and edges with errors up to `noise` and information matrices of full rank.
pub(crate) fn noisy_walk<G: PoseGroup<DOF>, const DOF: usize>(
    nodes: usize,
    landmarks: usize,
    noise: f64,
    seed: u64,
) -> (Vec<G>, Vec<Edge<G, DOF>>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut tangent = |size: f64| SVector::<f64, DOF>::from_fn(|_, _| random.random_range(-size..size));
    let mut poses = vec![G::exp(&tangent(2.0))];
    for index in 1..nodes {
        poses.push(poses[index - 1].compose(&G::exp(&tangent(1.0))));
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed + 1);
    let mut edge = |from: usize, to: usize, kind| {
        let spread = SMatrix::<f64, DOF, DOF>::from_fn(|_, _| random.random_range(-1.0..1.0));
        let error = SVector::<f64, DOF>::from_fn(|_, _| random.random_range(-noise..noise));
        let measurement = poses[from].between(&poses[to]).compose(&G::exp(&error));
        let information = (spread * spread.transpose() + SMatrix::identity()) * 10.0;
        Edge::new(from, to, measurement, information, kind)
    };
    let mut edges: Vec<_> = (1..nodes).map(|node| edge(node - 1, node, EdgeKind::Odometry)).collect();
    let mut ends = ChaCha8Rng::seed_from_u64(seed + 2);
    for _ in 0..landmarks {
        let (a, b) = (ends.random_range(0..nodes), ends.random_range(0..nodes));
        if a != b {
            edges.push(edge(a, b, EdgeKind::Landmark));
        }
    }
    (poses, edges)
}

/// A noisy walk with errors up to 0.03; the given poses are the truth, a little disturbed.
pub(crate) fn disturbed_walk<G: PoseGroup<DOF>, const DOF: usize>(
    nodes: usize,
    landmarks: usize,
    seed: u64,
) -> (Vec<G>, Vec<Edge<G, DOF>>) {
    let (truth, edges) = noisy_walk::<G, DOF>(nodes, landmarks, 0.03, seed);
    let mut random = ChaCha8Rng::seed_from_u64(seed + 3);
    let mut disturbed =
        |pose: &G| pose.compose(&G::exp(&SVector::from_fn(|_, _| random.random_range(-0.05..0.05))));
    (truth.iter().map(&mut disturbed).collect(), edges)
}

/// Largest distance between two lists of poses, in the tangent space.
pub(crate) fn apart<G: LieGroup<DOF>, const DOF: usize>(first: &[G], second: &[G]) -> f64 {
    first.iter().zip(second).map(|(a, b)| a.between(b).log().amax()).fold(0.0, f64::max)
}

/// The bits of the components.
pub(crate) fn bits<G: LieGroup<DOF>, const DOF: usize>(pose: &G) -> Vec<u64> {
    pose.components().iter().map(|component| component.to_bits()).collect()
}

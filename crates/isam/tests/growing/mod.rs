//! Growing trajectories, and fresh batch solutions to compare with.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_isam::{IncrementalGroup, IncrementalSolver};
use posecut_optimize::{Edge, EdgeKind, Options, Problem, optimize};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(crate) fn planar(random: &mut ChaCha8Rng) -> SE2 {
    SE2::new(random.random_range(-3.0..3.0), random.random_range(-3.0..3.0), random.random_range(-3.1..3.1))
}

pub(crate) fn spatial(random: &mut ChaCha8Rng) -> SE3 {
    let mut draw = |size: f64| random.random_range(-size..size);
    SE3::from_euler(draw(3.0), draw(3.0), draw(3.0), draw(3.1), draw(1.5), draw(3.1))
}

/// A growing trajectory, and noisy measurements in it.
pub(crate) struct World<G, const DOF: usize> {
    pub(crate) truth: Vec<G>,
    random: ChaCha8Rng,
    step: fn(&mut ChaCha8Rng) -> G,
    noise: f64,
}

impl<G: LieGroup<DOF>, const DOF: usize> World<G, DOF> {
    pub(crate) fn new(seed: u64, noise: f64, step: fn(&mut ChaCha8Rng) -> G) -> Self {
        Self { truth: vec![G::identity()], random: ChaCha8Rng::seed_from_u64(seed), step, noise }
    }

    pub(crate) fn grow(&mut self) -> usize {
        let step = (self.step)(&mut self.random);
        self.truth.push(self.truth[self.truth.len() - 1].compose(&step));
        self.truth.len() - 1
    }

    /// Information matrices differ from edge to edge and are not diagonal.
    pub(crate) fn measure(&mut self, from: usize, to: usize, kind: EdgeKind) -> Edge<G, DOF> {
        let noise = self.noise;
        let random = &mut self.random;
        let tangent = SVector::<f64, DOF>::from_fn(|_, _| random.random_range(-noise..noise));
        let root = SMatrix::<f64, DOF, DOF>::from_fn(|_, _| random.random_range(-0.5..0.5));
        let information = (SMatrix::identity() + root * root.transpose()) / (noise * noise);
        let measurement = self.truth[from].between(&self.truth[to]).compose(&G::exp(&tangent));
        Edge::new(from, to, measurement, information, kind)
    }

    pub(crate) fn any(&mut self, count: usize) -> usize {
        self.random.random_range(0..count)
    }
}

/// Two dense Gauss-Newton steps with the gauges held. They refine the batch solution, which stops where the cost can no
/// longer tell steps apart, at the root of the unit round-off.
pub(crate) fn refine<G: LieGroup<DOF>, const DOF: usize>(
    mut poses: Vec<G>,
    edges: &[Edge<G, DOF>],
    gauges: &[usize],
) -> Vec<G> {
    for _ in 0..2 {
        let size = poses.len() * DOF;
        let (mut matrix, mut vector) = (DMatrix::<f64>::zeros(size, size), DVector::<f64>::zeros(size));
        for edge in edges {
            let relative = poses[edge.from].between(&poses[edge.to]);
            let error = edge.measurement.between(&relative).log();
            let to = G::right_jacobian_inverse(&error);
            let from = -to * relative.inverse().adjoint();
            for (a, left) in [(edge.from, &from), (edge.to, &to)] {
                let weighted = left.transpose() * edge.information;
                let mut rows = vector.fixed_rows_mut::<DOF>(a * DOF);
                rows -= weighted * error;
                for (b, right) in [(edge.from, &from), (edge.to, &to)] {
                    let mut block = matrix.fixed_view_mut::<DOF, DOF>(a * DOF, b * DOF);
                    block += weighted * right;
                }
            }
        }
        for &gauge in gauges {
            for index in gauge * DOF..(gauge + 1) * DOF {
                matrix.row_mut(index).fill(0.0);
                matrix.column_mut(index).fill(0.0);
                matrix[(index, index)] = 1.0;
                vector[index] = 0.0;
            }
        }
        let step = matrix.cholesky().unwrap().solve(&vector);
        for (node, pose) in poses.iter_mut().enumerate() {
            *pose = pose.compose(&G::exp(&step.fixed_rows::<DOF>(node * DOF).into_owned()));
        }
    }
    poses
}

/// Largest distance of a pose from that of a fresh batch solution that gets only the gauges; and both costs.
pub(crate) fn distance_from_fresh<G: IncrementalGroup<DOF>, const DOF: usize>(
    solver: &IncrementalSolver<G, DOF>,
) -> (f64, f64, f64) {
    let edges: Vec<_> = solver.edges().into_iter().map(|(_, edge)| edge).collect();
    let estimates = solver.estimates();
    let ends = edges.iter().map(|edge| (edge.from, edge.to));
    let components = posecut_graph::connectivity::connected_components(estimates.len(), ends);
    let mut given = vec![G::identity(); estimates.len()];
    for component in &components {
        given[component.nodes[0]] = estimates[component.nodes[0]];
    }
    let strict = Options { cost_tolerance: 0.0, step_tolerance: 1e-12, ..Options::default() };
    let fresh = optimize(&Problem::new(given, edges.clone()).unwrap(), &strict);
    assert_eq!(components.len(), solver.parts());
    let gauges: Vec<usize> = components.iter().map(|component| component.nodes[0]).collect();
    let refined = refine(fresh.poses, &edges, &gauges);
    let distances = estimates.iter().zip(&refined).map(|(a, b)| a.between(b).log().amax());
    (distances.fold(0.0, f64::max), solver.cost(), fresh.cost)
}

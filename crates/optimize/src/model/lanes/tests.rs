//! Lanes beside single edges.

use super::*;
use crate::model::cost::total;
use crate::model::kernel::Kernel;
use crate::model::problem::EdgeKind;
use crate::model::retraction::{moved_apart, retract};
use crate::model::term::Term;
use faer::traits::pulp::WithSimd;
use nalgebra::SMatrix;
use posecut_cholesky::instructions::for_small_blocks;
use posecut_geometry::{SE2, SE3};
use proptest::prelude::*;

/// Edges by lanes, and whether the lanes computed them.
struct ByLanes<'a, G, const DOF: usize>(&'a [Edge<G, DOF>], &'a [G]);

impl<G: LaneGroup<DOF>, const DOF: usize> WithSimd for ByLanes<'_, G, DOF> {
    type Output = Vec<(f64, Gradient<DOF>, Linearised<DOF>, bool)>;

    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(edges, poses) = self;
        let mut all = Vec::new();
        for edges in edges.chunks(S::F64_LANES) {
            let mut costs = vec![f64::NAN; edges.len()];
            let mut gradients = vec![Gradient::zero(); edges.len()];
            let mut models = vec![Linearised::zero(); edges.len()];
            let is_computed = G::costs(simd, edges, poses, &mut costs);
            assert_eq!(G::gradients(simd, edges, poses, &mut gradients), is_computed);
            assert_eq!(G::models(simd, edges, poses, &mut models), is_computed);
            let each = costs.into_iter().zip(gradients).zip(models);
            all.extend(each.map(|((cost, gradient), model)| (cost, gradient, model, is_computed)));
        }
        all
    }
}

/// Compares lanes with single edges. Seven edges leave a lane empty in registers of four or eight.
fn check<G: LaneGroup<DOF>, const DOF: usize>(
    numbers: &[f64],
    turn: f64,
    kernel: Option<Kernel>,
) -> Result<(), TestCaseError> {
    let vector = |seed: usize, size: f64| {
        SVector::<f64, DOF>::from_fn(|axis, _| size * numbers[(seed * 5 + axis * 7) % numbers.len()])
    };
    let poses: Vec<G> = (0..5).map(|node| G::exp(&(vector(node, 3.0)))).collect();
    let edges: Vec<_> = (0..7)
        .map(|index| {
            let (from, to) = (index % 5, (3 * index + 1) % 5);
            let error = G::exp(&vector(index + 9, turn));
            let spread =
                SMatrix::<f64, DOF, DOF>::from_fn(|row, column| numbers[(index + row * 3 + column * 8) % 29]);
            let information = SMatrix::identity() + spread * spread.transpose() * 40.0;
            let measured = poses[from].between(&poses[to]).compose(&error);
            let kernel = kernel.filter(|_| index % 3 != 0);
            Edge { kernel, ..Edge::new(from, to, measured, information, EdgeKind::Landmark) }
        })
        .collect();
    for (edge, (cost, gradient, model, is_computed)) in
        edges.iter().zip(for_small_blocks(ByLanes(&edges, &poses)))
    {
        prop_assert!(is_computed);
        let expected = edge.linearise(&poses);
        // Rounding of a pose, times the information.
        let close = |found: &[f64], expected: &[f64]| {
            let largest = expected.iter().fold(10.0, |largest: f64, entry| largest.max(entry.abs()));
            found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= 2e-13 * largest)
        };
        prop_assert!(close(&[cost, gradient.cost, model.cost], &[expected.cost; 3]));
        for (found, expected) in [
            (&gradient.to, &expected.to_gradient),
            (&gradient.from, &expected.from_gradient),
            (&model.to_gradient, &expected.to_gradient),
            (&model.from_gradient, &expected.from_gradient),
        ] {
            prop_assert!(close(found.as_slice(), expected.as_slice()), "{found} {expected}");
        }
        for (found, expected) in [
            (&model.to_to, &expected.to_to),
            (&model.from_to, &expected.from_to),
            (&model.from_from, &expected.from_from),
        ] {
            prop_assert!(close(found.as_slice(), expected.as_slice()), "{found} {expected}");
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn lanes_and_single_edges_agree(
        numbers in prop::collection::vec(-1.0..1.0_f64, 31),
        turn in prop_oneof![Just(0.0), 1e-9..1e-3_f64, 1e-3..0.4_f64],
        kernel in prop_oneof![Just(None), Just(Some(Kernel::Cauchy(1.0))), Just(Some(Kernel::Huber(0.5)))],
    ) {
        check::<SE2, 3>(&numbers, turn, kernel)?;
        check::<SE3, 6>(&numbers, turn, kernel)?;
    }
}

/// Compares moves by lanes with moves of single poses. Seven poses leave a lane empty.
fn check_moves<G: LaneGroup<DOF>, const DOF: usize>(numbers: &[f64], size: f64) -> Result<(), TestCaseError> {
    let vector = |seed: usize, size: f64| {
        SVector::<f64, DOF>::from_fn(|axis, _| size * numbers[(seed * 5 + axis * 7) % numbers.len()])
    };
    let poses: Vec<G> = (0..7).map(|node| G::exp(&(vector(node, 3.0)))).collect();
    let steps: Vec<_> = (0..7).map(|node| vector(node + 9, size)).collect();
    let mut moved = poses.clone();
    retract(&poses, &steps, &mut moved);
    for ((pose, step), moved) in poses.iter().zip(&steps).zip(&moved) {
        let expected = moved_apart(pose, step);
        prop_assert!(expected.between(moved).log().amax() < 1e-14, "{expected:?} {moved:?}");
    }
    Ok(())
}

proptest! {
    /// Steps of up to 2 rad: longer ones than lanes compute are among them.
    #[test]
    fn moves_by_lanes_and_of_single_poses_agree(
        numbers in prop::collection::vec(-1.0..1.0_f64, 31),
        size in prop_oneof![Just(0.0), 1e-9..1e-3_f64, 1e-3..2.0_f64],
    ) {
        check_moves::<SE2, 3>(&numbers, size)?;
        check_moves::<SE3, 6>(&numbers, size)?;
    }
}

/// One edge that turns far, or is not a number, makes its register give up; the term then falls back to single edges.
#[test]
fn lanes_leave_large_errors_to_single_edges() {
    for angle in [1.0, 3.0, -3.1, f64::NAN] {
        let edge = |angle| {
            Edge::new(0, 1, SE2::new(1.0, 0.0, angle), nalgebra::Matrix3::identity(), EdgeKind::Landmark)
        };
        let poses = [SE2::new(0.0, 0.0, 0.1), SE2::new(1.0, 0.2, 0.2)];
        let edges = [edge(0.0), edge(angle)];
        let mut costs = [7.0; 2];
        assert!(!SE2::costs(faer::traits::pulp::Scalar, &edges[1..], &poses, &mut costs[1..]));
        assert_eq!(costs[1], 7.0);
        assert_eq!(total(&edges[1..], &poses).to_bits(), edges[1].cost(&poses).to_bits());
        let far = SE3::from_euler(0.0, 0.0, 0.0, 0.5, 0.5, angle);
        let edge = Edge::new(0, 1, far, nalgebra::Matrix6::identity(), EdgeKind::Landmark);
        let poses = [SE3::identity(), SE3::identity()];
        assert!(!SE3::costs(faer::traits::pulp::Scalar, &[edge], &poses, &mut costs[..1]));
    }
}

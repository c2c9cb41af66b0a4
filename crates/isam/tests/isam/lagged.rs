//! Sessions with landmark edges to recent poses.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use posecut_geometry::LieGroup;
use posecut_isam::{IncrementalGroup, IncrementalOptions, IncrementalSolver};
use posecut_optimize::{Edge, EdgeKind};
use rand_chacha::ChaCha8Rng;

use crate::growing::World;

/// All points of linearisation stay where edges first put the poses.
pub(crate) fn frozen() -> IncrementalOptions {
    IncrementalOptions {
        relinearise_translation: 1e300,
        relinearise_rotation: 1e300,
        propagate: 0.0,
        iterations: 1,
        ..IncrementalOptions::default()
    }
}

/// A trajectory with landmark edges to poses at most `reach` back.
pub(crate) struct Session<G, const DOF: usize> {
    pub(crate) world: World<G, DOF>,
    pub(crate) edges: Vec<(usize, Edge<G, DOF>)>,
}

pub(crate) fn session<G: LieGroup<DOF>, const DOF: usize>(
    seed: u64,
    noise: f64,
    [poses, reach]: [usize; 2],
    step: fn(&mut ChaCha8Rng) -> G,
) -> Session<G, DOF> {
    let mut world = World::<G, DOF>::new(seed, noise, step);
    let mut edges = Vec::new();
    for _ in 1..poses {
        let node = world.grow();
        edges.push((node, world.measure(node - 1, node, EdgeKind::Odometry)));
        if node > reach && world.any(2) == 0 {
            let earlier = node - 2 - world.any(reach - 2);
            edges.push((node, world.measure(earlier, node, EdgeKind::Landmark)));
        }
    }
    Session { world, edges }
}

pub(crate) fn play<G: IncrementalGroup<DOF>, const DOF: usize>(
    solver: &mut IncrementalSolver<G, DOF>,
    session: &Session<G, DOF>,
    each: impl Fn(&mut IncrementalSolver<G, DOF>, usize),
) {
    for node in 0..session.world.truth.len() {
        solver.add_pose(G::identity()).unwrap();
        for (_, edge) in session.edges.iter().filter(|(at, _)| *at == node) {
            solver.add_edge(*edge).unwrap();
        }
        solver.update();
        each(solver, node);
    }
}

/// Largest difference of poses over those that `solver` has not marginalised.
pub(crate) fn apart_on_live<G: IncrementalGroup<DOF>, const DOF: usize>(
    solver: &IncrementalSolver<G, DOF>,
    other: &[G],
) -> f64 {
    let distances =
        solver.live_poses().iter().map(|&node| solver.estimate(node).between(&other[node]).log().amax());
    distances.fold(0.0, f64::max)
}

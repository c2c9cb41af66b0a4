//! Compares distances in O(1) with a composition of every step of both loops, and with a Monte Carlo of the noise.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, PoseGraph};
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::consistency::{squared_distance, squared_distance_to_odometry};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

fn normal<const DOF: usize>(random: &mut ChaCha8Rng, sigma: &SVector<f64, DOF>) -> SVector<f64, DOF> {
    SVector::from_fn(|axis, _| {
        let unit: f64 = StandardNormal.sample(random);
        sigma[axis] * unit
    })
}

/// A full (not diagonal) covariance and its information, packed.
fn noise<const DOF: usize>(scale: f64) -> (SMatrix<f64, DOF, DOF>, Vec<f64>) {
    let root = SMatrix::<f64, DOF, DOF>::from_fn(|i, j| match i.cmp(&j) {
        std::cmp::Ordering::Equal => scale * (1.0 + i as f64 * 0.1),
        std::cmp::Ordering::Greater => 0.2 * scale,
        std::cmp::Ordering::Less => 0.0,
    });
    let covariance = root * root.transpose();
    let information = posecut_geometry::covariance::information_from_covariance(&covariance).unwrap();
    (covariance, posecut_geometry::covariance::pack_upper_triangle(&information))
}

struct World<G, const DOF: usize> {
    graph: PoseGraph,
    truth: Vec<G>,
    steps: Vec<G>,
    step_covariance: SMatrix<f64, DOF, DOF>,
    landmark_covariance: SMatrix<f64, DOF, DOF>,
}

/// Two chains of `length` nodes each (or one of twice the length) on wandering routes, with noisy odometry and landmark
/// edges between the given nodes.
fn world<G: LieGroup<DOF>, const DOF: usize>(
    length: usize,
    one_chain: bool,
    landmarks: &[(usize, usize)],
    seed: u64,
) -> World<G, DOF> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (step_covariance, step_information) = noise::<DOF>(1e-4);
    let (landmark_covariance, landmark_information) = noise::<DOF>(2e-4);
    let step_root = step_covariance.cholesky().unwrap().l();
    let landmark_root = landmark_covariance.cholesky().unwrap().l();
    let unit = SVector::<f64, DOF>::repeat(1.0);
    let dimension = if DOF == 3 { Dimension::Two } else { Dimension::Three };
    let mut graph = PoseGraph::new(Header::new(dimension));
    let (mut truth, mut steps) = (Vec::<G>::new(), Vec::new());
    for id in 0..2 * length {
        let start = id == 0 || (id == length && !one_chain);
        let session = if id < length { "a" } else { "b" };
        graph.nodes.push(Node { id: id as u64, session: Some(session.to_owned()), ..Node::default() });
        if start {
            truth.push(G::exp(&normal(&mut random, &(2.0 * unit))));
            steps.push(G::identity());
            continue;
        }
        let mut way = normal(&mut random, &(0.3 * unit));
        way[0] += 1.0;
        let motion = G::exp(&way);
        truth.push(truth[id - 1].compose(&motion));
        let measured = motion.compose(&G::exp(&(step_root * normal(&mut random, &unit))));
        steps.push(measured);
        let mut edge = Edge::new(EdgeKind::Odometry, graph.edges.len() as u64, id as u64 - 1, id as u64);
        edge.measurement = Some(measured.components());
        edge.information = Some(step_information.clone());
        graph.edges.push(edge);
    }
    for &(from, to) in landmarks {
        let exact = truth[from].between(&truth[to]);
        let measured = exact.compose(&G::exp(&(landmark_root * normal(&mut random, &unit))));
        let mut edge = Edge::new(EdgeKind::Landmark, graph.edges.len() as u64, from as u64, to as u64);
        edge.measurement = Some(measured.components());
        edge.information = Some(landmark_information.clone());
        graph.edges.push(edge);
    }
    World { graph, truth, steps, step_covariance, landmark_covariance }
}

/// The distance of the only pair of candidates.
fn distance<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph) -> f64 {
    let chains = Chains::<G, DOF>::of(graph).unwrap();
    let grouped = group(graph, &chains).unwrap();
    let found = &grouped.groups[0];
    let (a, b) = (&found.candidates[0], &found.candidates[1]);
    let (chain_a, chain_b) = (&chains.chains[found.a], &chains.chains[found.b]);
    squared_distance(chain_a, chain_b, found.a == found.b, a, b).unwrap()
}

/// The error and covariance of the loop i -> j -> l -> k -> i, composed step by step. Differences carry the noise of every
/// step to the end of the loop; each step counts once, with the sum of all its effects.
fn composed<G: LieGroup<DOF>, const DOF: usize>(
    world: &World<G, DOF>,
    a: (usize, usize),
    b: (usize, usize),
) -> f64 {
    let measured = |edge: usize| {
        let landmarks: Vec<_> = world.graph.edges_of(EdgeKind::Landmark).collect();
        G::from_components(landmarks[edge].measurement.as_ref().unwrap()).unwrap()
    };
    let (z_a, z_b) = (measured(0), measured(1));
    let walk = |from: usize, to: usize, steps: &[G]| {
        let mut pose = G::identity();
        if from <= to {
            (from + 1..=to).for_each(|node| pose = pose.compose(&steps[node]));
        } else {
            (to + 1..=from).rev().for_each(|node| pose = pose.compose(&steps[node].inverse()));
        }
        pose
    };
    let loop_error = |z_a: &G, z_b: &G, steps: &[G]| {
        z_a.inverse().compose(&walk(a.0, b.0, steps)).compose(z_b).compose(&walk(b.1, a.1, steps)).log()
    };
    let error = loop_error(&z_a, &z_b, &world.steps);
    let small = 1e-7;
    let effect = |moved: &dyn Fn(&G) -> SVector<f64, DOF>| {
        SMatrix::<f64, DOF, DOF>::from_fn(|row, axis| {
            let mut xi = SVector::<f64, DOF>::zeros();
            xi[axis] = small;
            let (plus, minus) = (moved(&G::exp(&xi)), moved(&G::exp(&-xi)));
            (plus[row] - minus[row]) / (2.0 * small)
        })
    };
    let mut covariance = SMatrix::<f64, DOF, DOF>::zeros();
    let mut add = |effect: SMatrix<f64, DOF, DOF>, noise: &SMatrix<f64, DOF, DOF>| {
        covariance += effect * noise * effect.transpose();
    };
    add(effect(&|moved| loop_error(&z_a.compose(moved), &z_b, &world.steps)), &world.landmark_covariance);
    add(effect(&|moved| loop_error(&z_a, &z_b.compose(moved), &world.steps)), &world.landmark_covariance);
    for node in 1..world.steps.len() {
        let moved_step = |moved: &G| {
            let mut steps = world.steps.clone();
            steps[node] = steps[node].compose(moved);
            loop_error(&z_a, &z_b, &steps)
        };
        add(effect(&moved_step), &world.step_covariance);
    }
    let inverse = covariance.try_inverse().unwrap();
    (error.transpose() * inverse * error)[(0, 0)]
}

/// To first order in the noise, formula and composition agree to the size of the noise, carried over the loop.
fn agrees<G: LieGroup<DOF>, const DOF: usize>(
    a: (usize, usize),
    b: (usize, usize),
    length: usize,
    one_chain: bool,
) {
    for seed in 0..6 {
        let world = world::<G, DOF>(length, one_chain, &[a, b], seed);
        assert_eq!(world.truth.len(), 2 * length);
        let (fast, slow) = (distance::<G, DOF>(&world.graph), composed(&world, a, b));
        assert!(
            (fast - slow).abs() < 0.01 * slow.max(1.0),
            "DOF {DOF}, {a:?} {b:?}, seed {seed}: {fast} against {slow}"
        );
    }
}

#[test]
fn two_chains_in_both_directions() {
    for (a, b) in
        [((2, 12), (8, 17)), ((8, 17), (2, 12)), ((3, 18), (7, 11)), ((4, 14), (4, 16)), ((5, 15), (9, 15))]
    {
        agrees::<SE2, 3>(a, b, 10, false);
        agrees::<SE3, 6>(a, b, 10, false);
    }
}

#[test]
fn one_chain_with_shared_steps_in_all_arrangements() {
    // Loops that are separate, nested, crossing, and in opposite directions.
    for (a, b) in
        [((1, 5), (9, 14)), ((1, 18), (4, 12)), ((2, 10), (6, 16)), ((3, 9), (9, 17)), ((2, 14), (3, 15))]
    {
        agrees::<SE2, 3>(a, b, 10, true);
        agrees::<SE3, 6>(a, b, 10, true);
    }
}

#[test]
fn an_edge_stored_from_b_to_a_means_the_same() {
    let plain = world::<SE3, 6>(10, false, &[(2, 12), (8, 17)], 3);
    let mut turned = plain.graph.clone();
    let last = turned.edges.len() - 1;
    let edge = &mut turned.edges[last];
    let measurement = SE3::from_components(edge.measurement.as_ref().unwrap()).unwrap();
    // Z^-1, and Ad(Z) Sigma Ad(Z)^T.
    let covariance = measurement.adjoint() * plain.landmark_covariance * measurement.adjoint().transpose();
    let information = posecut_geometry::covariance::information_from_covariance(&covariance).unwrap();
    edge.measurement = Some(measurement.inverse().components());
    edge.information = Some(posecut_geometry::covariance::pack_upper_triangle(&information));
    (edge.from, edge.to) = (edge.to, edge.from);
    let (a, b) = (distance::<SE3, 6>(&plain.graph), distance::<SE3, 6>(&turned));
    assert!((a - b).abs() < 1e-6 * a.max(1.0), "{a} {b}");
}

#[test]
fn odometry_stored_backwards_means_the_same() {
    let plain = world::<SE2, 3>(10, false, &[(2, 12), (8, 17)], 5);
    let mut turned = plain.graph.clone();
    for edge in turned.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Odometry && edge.id % 3 == 0) {
        let measurement = SE2::from_components(edge.measurement.as_ref().unwrap()).unwrap();
        let covariance = measurement.adjoint() * plain.step_covariance * measurement.adjoint().transpose();
        let information = posecut_geometry::covariance::information_from_covariance(&covariance).unwrap();
        edge.measurement = Some(measurement.inverse().components());
        edge.information = Some(posecut_geometry::covariance::pack_upper_triangle(&information));
        (edge.from, edge.to) = (edge.to, edge.from);
    }
    let (a, b) = (distance::<SE2, 3>(&plain.graph), distance::<SE2, 3>(&turned));
    assert!((a - b).abs() < 1e-6 * a.max(1.0), "{a} {b}");
}

/// Kolmogorov-Smirnov: how far the distances of true pairs are from the chi-square distribution.
fn kolmogorov_smirnov<G: LieGroup<DOF>, const DOF: usize>(
    one_chain: bool,
    distance: impl Fn(&PoseGraph) -> f64,
) -> f64 {
    use statrs::distribution::{ChiSquared, ContinuousCDF};
    let count = 600;
    let mut distances: Vec<f64> = (0..count)
        .map(|seed| distance(&world::<G, DOF>(10, one_chain, &[(2, 12), (8, 17)], 1000 + seed).graph))
        .collect();
    distances.sort_by(f64::total_cmp);
    let chi_squared = ChiSquared::new(DOF as f64).unwrap();
    distances
        .iter()
        .enumerate()
        .map(|(index, distance)| (chi_squared.cdf(*distance) - (index as f64 + 0.5) / count as f64).abs())
        .fold(0.0, f64::max)
}

/// The 1 % point of the statistic: 1.63 / sqrt(600).
const KOLMOGOROV_SMIRNOV: f64 = 0.0665;

#[test]
fn distances_of_true_pairs_are_chi_square_distributed() {
    for one_chain in [false, true] {
        let plane = kolmogorov_smirnov::<SE2, 3>(one_chain, distance::<SE2, 3>);
        let space = kolmogorov_smirnov::<SE3, 6>(one_chain, distance::<SE3, 6>);
        assert!(
            plane < KOLMOGOROV_SMIRNOV && space < KOLMOGOROV_SMIRNOV,
            "one chain {one_chain}: {plane} {space}"
        );
    }
}

/// The distance of the first candidate from the odometry of its own chain.
fn distance_to_odometry<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph) -> f64 {
    let chains = Chains::<G, DOF>::of(graph).unwrap();
    let grouped = group(graph, &chains).unwrap();
    squared_distance_to_odometry(&chains.chains[0], &grouped.groups[0].candidates[0]).unwrap()
}

#[test]
fn distances_to_the_odometry_are_chi_square_distributed() {
    let plane = kolmogorov_smirnov::<SE2, 3>(true, distance_to_odometry::<SE2, 3>);
    let space = kolmogorov_smirnov::<SE3, 6>(true, distance_to_odometry::<SE3, 6>);
    assert!(plane < KOLMOGOROV_SMIRNOV && space < KOLMOGOROV_SMIRNOV, "{plane} {space}");
}

/// As `distance`, but with the adjoint of the alignment instead of that of its inverse.
fn distance_with_a_wrong_adjoint<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph) -> f64 {
    let chains = Chains::<G, DOF>::of(graph).unwrap();
    let mut grouped = group(graph, &chains).unwrap();
    let found = &mut grouped.groups[0];
    found.candidates[0].to_b = found.candidates[0].alignment.adjoint();
    let (a, b) = (&found.candidates[0], &found.candidates[1]);
    let (chain_a, chain_b) = (&chains.chains[found.a], &chains.chains[found.b]);
    squared_distance(chain_a, chain_b, found.a == found.b, a, b).unwrap()
}

#[test]
fn the_chi_square_test_notices_a_wrong_adjoint() {
    let plane = kolmogorov_smirnov::<SE2, 3>(false, distance_with_a_wrong_adjoint::<SE2, 3>);
    let space = kolmogorov_smirnov::<SE3, 6>(false, distance_with_a_wrong_adjoint::<SE3, 6>);
    assert!(plane > KOLMOGOROV_SMIRNOV && space > KOLMOGOROV_SMIRNOV, "{plane} {space}");
}

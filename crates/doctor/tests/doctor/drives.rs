//! Small drives with known noise, which have nothing wrong unless a test spoils them.

use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{Dimension, Edge, EdgeKind, EdgeTruth, Header, Node, NodeTruth, PoseGraph};
use posecut_random::rand::RngExt as _;
use posecut_random::{ChaCha8Rng, random};

/// Nodes in a lap.
pub(crate) const LAP: usize = 120;
/// Standard deviations of odometry and landmark edges, metres and radians.
pub(crate) const ODOMETRY: [f64; 2] = [0.03, 0.004];
pub(crate) const LANDMARK: [f64; 2] = [0.1, 0.02];

/// Two laps in the plane: 240 nodes, and a landmark edge from each node of the first lap to that of the second. Poses are dead
/// reckoning; nodes and edges have truth, frames and times.
pub(crate) fn plane() -> PoseGraph {
    laps(2)
}

/// The same in space, with some height.
pub(crate) fn space() -> PoseGraph {
    build::<SE3, 6>(Dimension::Three, 2)
}

/// Several laps in the plane. Landmark edges join each lap to all later ones.
pub(crate) fn laps(count: usize) -> PoseGraph {
    build::<SE2, 3>(Dimension::Two, count)
}

/// The information matrix of these standard deviations.
pub(crate) fn information(dimension: Dimension, deviations: [f64; 2]) -> Vec<f64> {
    posecut_geometry::covariance::isotropic_information(
        dimension.degrees_of_freedom(),
        deviations[0],
        deviations[1],
    )
}

/// The edges of one kind.
pub(crate) fn edges_of(graph: &mut PoseGraph, kind: EdgeKind) -> impl Iterator<Item = &mut Edge> {
    graph.edges.iter_mut().filter(move |edge| edge.kind == kind)
}

/// The true pose of a node: an oval that is not symmetric, so that places differ.
fn place(node: usize) -> SE3 {
    let angle = std::f64::consts::TAU * (node % LAP) as f64 / LAP as f64;
    let position = |angle: f64| (40.0 * angle.cos() + 6.0 * (2.0 * angle).sin(), 22.0 * angle.sin());
    let ((x, y), (next_x, next_y)) = (position(angle), position(angle + 1e-4));
    SE3::from_euler(x, y, (3.0 * angle).sin(), 0.0, 0.0, (next_y - y).atan2(next_x - x))
}

fn build<G: LieGroup<DOF>, const DOF: usize>(dimension: Dimension, laps: usize) -> PoseGraph {
    let mut graph = PoseGraph::new(Header::new(dimension));
    let truth: Vec<G> = (0..laps * LAP)
        .map(|node| G::from_components(&dimension.components(&place(node))).unwrap())
        .collect();
    let mut noise = random(1, "drives of the doctor's tests");
    let mut reckoned = truth[0];
    for (node, pose) in truth.iter().enumerate() {
        if node > 0 {
            let motion = noisy(&truth[node - 1].between(pose), ODOMETRY, &mut noise);
            reckoned = reckoned.compose(&motion);
            graph.edges.push(edge(
                EdgeKind::Odometry,
                node - 1,
                node - 1,
                node,
                &motion,
                ODOMETRY,
                dimension,
            ));
        }
        let real = NodeTruth { pose: Some(pose.components()), ..NodeTruth::default() };
        graph.nodes.push(Node {
            id: node as u64,
            session: Some("drive".to_owned()),
            frame: Some(node as i64),
            utime: Some(1_300_000_000_000_000 + 2_000_000 * node as i64),
            pose: Some(reckoned.components()),
            truth: Some(real),
            ..Node::default()
        });
    }
    let pairs = (0..laps).flat_map(|one| (one + 1..laps).map(move |other| (one, other)));
    for ((one, other), node) in pairs.flat_map(|pair| (0..LAP).map(move |node| (pair, node))) {
        let (from, to) = (one * LAP + node, other * LAP + node);
        let motion = noisy(&truth[from].between(&truth[to]), LANDMARK, &mut noise);
        let mut landmark =
            edge(EdgeKind::Landmark, graph.edges.len() + 1, from, to, &motion, LANDMARK, dimension);
        landmark.truth = Some(EdgeTruth::of(true));
        graph.edges.push(landmark);
    }
    graph
}

fn edge<G: LieGroup<DOF>, const DOF: usize>(
    kind: EdgeKind,
    id: usize,
    from: usize,
    to: usize,
    motion: &G,
    deviations: [f64; 2],
    dimension: Dimension,
) -> Edge {
    let mut edge = Edge::new(kind, id as u64, from as u64, to as u64);
    edge.measurement = Some(motion.components());
    edge.information = Some(information(dimension, deviations));
    edge
}

fn noisy<G: LieGroup<DOF>, const DOF: usize>(motion: &G, deviations: [f64; 2], noise: &mut ChaCha8Rng) -> G {
    let translations = if DOF == 3 { 2 } else { 3 };
    let error = nalgebra::SVector::<f64, DOF>::from_fn(|axis, _| {
        deviations[usize::from(axis >= translations)] * normal(noise)
    });
    motion.compose(&G::exp(&error))
}

/// A normal number, by the sum of twelve uniform ones.
fn normal(noise: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| noise.random::<f64>()).sum::<f64>() - 6.0
}

/// Splits the drive into two sessions `a` and `b` without odometry between them.
pub(crate) fn split(mut graph: PoseGraph) -> PoseGraph {
    for (index, node) in graph.nodes.iter_mut().enumerate() {
        node.session = Some(if index < LAP { "a" } else { "b" }.to_owned());
    }
    graph.edges.retain(|edge| edge.kind == EdgeKind::Landmark || edge.from != LAP as u64 - 1);
    graph
}

/// The planar motion of components.
pub(crate) fn motion(edge: &Edge) -> SE2 {
    SE2::from_components(edge.measurement.as_deref().unwrap()).unwrap()
}

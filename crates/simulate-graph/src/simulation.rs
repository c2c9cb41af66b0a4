//! A graph from a seed.

use posecut_geometry::LieGroup;
use posecut_geometry::covariance::isotropic_information;
use posecut_graph::{
    Dimension, Edge, EdgeKind, EdgeTruth, Extra, Header, Node, NodeTruth, NoiseModel, PoseGraph,
    for_dimension,
};
use posecut_random::random;

use crate::landmarks::Scene;
use crate::mistakes::Claims;
use crate::noise::Noise;
use crate::odometry::odometry;
use crate::world::Walks;
use crate::{Character, OptionError, Options};

/// The most poses of a graph, which is in memory as a whole.
const MOST_POSES: usize = 5_000_000;

/// Paths that are tried until robots see some place twice.
const ATTEMPTS: usize = 20;

/// A simulated graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// Nodes with the poses of odometry, edges of both kinds, and the truth of all of them.
    pub graph: PoseGraph,
    /// What was drawn for it.
    pub character: Character,
    /// The number of correct landmark edges.
    pub correct_edges: usize,
    /// The number of incorrect landmark edges: fewer than the rate asks for where the world has no room for them.
    pub incorrect_edges: usize,
}

/// Simulates a graph. O(nodes + edges).
pub fn simulate(options: &Options) -> Result<Simulated, OptionError> {
    options.check()?;
    let character = Character::draw(options);
    let poses = character.robots.saturating_mul(character.poses);
    if poses > MOST_POSES {
        return Err(OptionError {
            option: "--poses",
            value: format!("{} for each of {} robots", character.poses, character.robots),
            expected: "such that all robots together have at most 5000000",
        });
    }
    let dimension = if character.dimension == 2 { Dimension::Two } else { Dimension::Three };
    Ok(for_dimension!(dimension, |G, DOF| simulated::<G, DOF>(dimension, character, options.seed)))
}

fn simulated<G: Walks<DOF>, const DOF: usize>(
    dimension: Dimension,
    character: Character,
    seed: u64,
) -> Simulated {
    // Where no place is seen twice, there is nothing to judge.
    let attempt = |attempt| {
        let paths = G::walks(&character, seed, attempt);
        let scene = Scene::<G, DOF>::new(&paths, &character);
        (paths, scene)
    };
    let seen_twice = (0..ATTEMPTS).map(attempt).find(|(_, scene)| !scene.similar.is_empty());
    let (paths, scene) = seen_twice.unwrap_or_else(|| attempt(0));
    let mut graph = PoseGraph::new(Header::new(dimension));
    for (name, (translation, rotation)) in
        [("odometry", character.odometry_sigma), ("landmark", character.landmark_sigma)]
    {
        let information = isotropic_information(DOF, translation, rotation);
        graph.header.noise_models.push((name.to_owned(), NoiseModel { information, extra: Extra::new() }));
    }
    add_robots(&mut graph, &paths, &character, seed);
    let (correct_edges, incorrect_edges) = add_landmark_edges(&mut graph, &scene, seed);
    Simulated { graph, character, correct_edges, incorrect_edges }
}

/// Adds the nodes and the odometry of all robots. Each starts at the origin of a frame of its own.
fn add_robots<G: LieGroup<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    paths: &[Vec<G>],
    character: &Character,
    seed: u64,
) {
    for (robot, path) in paths.iter().enumerate() {
        let steps = odometry(path, character, &mut random(seed, &format!("odometry of robot {robot}")));
        let first = graph.nodes.len() as u64;
        let mut pose = G::identity();
        for (frame, truth) in path.iter().enumerate() {
            graph.nodes.push(Node {
                id: first + frame as u64,
                session: Some(format!("robot-{}", robot + 1)),
                frame: Some(frame as i64),
                pose: Some(pose.components()),
                truth: Some(NodeTruth { pose: Some(truth.components()), extra: Extra::new() }),
                ..Node::default()
            });
            let Some(step) = steps.get(frame) else { continue };
            pose = pose.compose(step);
            let from = first + frame as u64;
            graph.edges.push(edge(graph.edges.len(), EdgeKind::Odometry, (from, from + 1), step));
        }
    }
}

/// Adds correct and incorrect edges, ordered by their nodes, so that an id does not reveal the truth. Returns how many of each.
fn add_landmark_edges<G: LieGroup<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    scene: &Scene<'_, G, DOF>,
    seed: u64,
) -> (usize, usize) {
    let character = scene.character;
    let correct = scene.recognised(&mut random(seed, "correct edges"));
    let wanted = correct.len() as f64 * character.incorrect_rate / (1.0 - character.incorrect_rate);
    let mut claims = Claims::new();
    for &(kind, share) in &character.mistakes {
        let stream = format!("incorrect edges: {}", kind.name());
        let number = (share * wanted).round() as usize;
        kind.draw(scene, number, &correct, &mut claims, &mut random(seed, &stream));
    }
    let incorrect = claims.len();

    let (translation, rotation) = character.landmark_sigma;
    let ratio = character.landmark_ratio;
    let noise = Noise { sigma: (ratio * translation, ratio * rotation), heavy_tails: character.heavy_tails };
    let right = correct.iter().map(|&(from, to)| ((from, to), scene.motion(from, to), None));
    let wrong = claims.into_iter().map(|(pair, (kind, claim))| (pair, claim, Some(kind)));
    let mut edges: Vec<_> = right.chain(wrong).collect();
    edges.sort_by_key(|&(pair, ..)| pair);
    let mut stream = random(seed, "noise of landmark edges");
    for ((from, to), motion, mistake) in edges {
        let measured = noise.applied(&motion, &mut stream);
        let mut edge = edge(graph.edges.len(), EdgeKind::Landmark, (from as u64, to as u64), &measured);
        let mut truth = EdgeTruth::of(mistake.is_none());
        if let Some(kind) = mistake {
            truth.extra.insert("mistake".to_owned(), kind.name().into());
        }
        edge.truth = Some(truth);
        graph.edges.push(edge);
    }
    (correct.len(), incorrect)
}

/// An edge with the noise model of its kind.
fn edge<G: LieGroup<DOF>, const DOF: usize>(
    id: usize,
    kind: EdgeKind,
    (from, to): (u64, u64),
    motion: &G,
) -> Edge {
    let mut edge = Edge::new(kind, id as u64, from, to);
    edge.measurement = Some(motion.components());
    edge.noise = Some(kind.name().to_owned());
    edge
}

//! Small graphs with everything that the format allows.

use nalgebra::SVector;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{Dimension, Edge, EdgeKind, EdgeTruth, Header, Node, NodeTruth, NoiseModel, PoseGraph};
use posecut_stage::ChaCha8Rng;
use rand::RngExt as _;
use rand_distr::{Distribution as _, StandardNormal};
use serde_json::{Value, json};

/// The number of nodes of each of the two sessions: one lap of a circle.
const LAP: usize = 160;
/// The length of a run of landmark edges.
const RUN: usize = 8;
/// The number of incorrect landmark edges.
const INCORRECT: usize = 12;
/// The stage that has rejected one edge of the sample before.
pub const EARLIER: &str = "earlier-stage";

/// Records of unknown kinds.
const UNKNOWN: [&str; 2] = [
    r#"{"kind":"weather","session":"a","rain":[0.1,null,true]}"#,
    r#"{"kind":"note","text":"é, \"quoted\", kept as it stands","number":1.5}"#,
];

/// The sample in the plane: two laps of a circle, with the truth of every node.
pub fn plane() -> PoseGraph {
    graph::<SE2, 3>(Dimension::Two, 1)
}

/// The same sample in space.
pub fn space() -> PoseGraph {
    graph::<SE3, 6>(Dimension::Three, 2)
}

/// Makes the sample. It has two sessions, each a lap of the same circle, with noisy odometry of a shared noise model. Between
/// them there are runs of correct landmark edges and single incorrect ones, some stored backwards, one without measurement,
/// and one that an earlier stage has rejected. Edges have truth and scores. The header, nodes, edges and truth have unknown
/// fields, and there are records of unknown kinds.
fn graph<G: LieGroup<DOF>, const DOF: usize>(dimension: Dimension, seed: u64) -> PoseGraph {
    let mut header = Header::new(dimension);
    let model = NoiseModel { information: diagonal::<DOF>(400.0), extra: object(json!({"from": "wheels"})) };
    header.noise_models.push(("odometry".to_owned(), model));
    header.extra = object(json!({"licence": "none", "calibration": {"focal": 0.1}}));
    header.provenance = vec![json!({"stage": "sample", "by": "posecut-conform"})];
    let mut graph = PoseGraph::new(header);
    let mut random = posecut_stage::random(seed, "conformance sample");
    let truth = add_laps::<G, DOF>(&mut graph, &mut random);
    for (number, &(first, second, correct)) in pairs(seed).iter().enumerate() {
        let (from, to) = if number % 3 == 0 { (second, first) } else { (first, second) };
        let exact = if correct { truth[from].between(&truth[to]) } else { G::identity() };
        let mut edge = Edge::new(EdgeKind::Landmark, 10_000 + number as u64, from as u64, to as u64);
        edge.measurement = Some(exact.compose(&noise(&mut random, 0.02)).components());
        edge.information = Some(diagonal::<DOF>(2500.0));
        edge.score = Some(if correct { 0.9 } else { 0.4 } - 0.001 * number as f64);
        edge.truth =
            Some(EdgeTruth { correct: Some(correct), extra: object(json!({"labelled_by": "sample"})) });
        if number % 5 == 0 {
            edge.extra =
                object(json!({"matches": {"inliers": 40 + number, "ratio": 0.1}, "seen": [1, null]}));
        }
        graph.edges.push(edge);
    }
    let mut unmeasured = Edge::new(EdgeKind::Landmark, 20_000, 1, LAP as u64 + 1);
    unmeasured.score = Some(0.8);
    unmeasured.truth = Some(EdgeTruth { correct: Some(true), extra: object(json!({})) });
    let mut marked = graph.edges[graph.edges.len() - 1].clone();
    marked.id = 20_001;
    marked.rejected_by = Some(EARLIER.to_owned());
    graph.edges.extend([unmeasured, marked]);
    graph.unknown = UNKNOWN.map(str::to_owned).to_vec();
    graph
}

/// A small random motion.
fn noise<G: LieGroup<DOF>, const DOF: usize>(random: &mut ChaCha8Rng, sigma: f64) -> G {
    G::exp(&SVector::from_fn(|_, _| {
        let unit: f64 = StandardNormal.sample(random);
        sigma * unit
    }))
}

/// Adds the nodes and the odometry of both sessions. Returns the true poses.
fn add_laps<G: LieGroup<DOF>, const DOF: usize>(graph: &mut PoseGraph, random: &mut ChaCha8Rng) -> Vec<G> {
    let mut tangent = SVector::<f64, DOF>::zeros();
    (tangent[0], tangent[DOF - 1]) = (1.0, std::f64::consts::TAU / LAP as f64);
    let step = G::exp(&tangent);
    let (mut truth, mut estimates) = (vec![G::identity()], vec![G::identity()]);
    for id in 0..2 * LAP {
        if id > 0 {
            let measured = step.compose(&noise(random, 0.01));
            truth.push(truth[id - 1].compose(&step));
            estimates.push(estimates[id - 1].compose(&measured));
            if id != LAP {
                let mut edge = Edge::new(EdgeKind::Odometry, id as u64, id as u64 - 1, id as u64);
                edge.measurement = Some(measured.components());
                edge.noise = Some("odometry".to_owned());
                graph.edges.push(edge);
            }
        }
        graph.nodes.push(Node {
            id: id as u64,
            session: Some(if id < LAP { "a" } else { "b" }.to_owned()),
            frame: Some((id % LAP) as i64),
            utime: Some(1_327_194_947_000_001 + id as i64 * 2_000_000),
            pose: Some(estimates[id].components()),
            truth: Some(NodeTruth {
                pose: Some(truth[id].components()),
                extra: object(json!({"surveyed": id % 2 == 0})),
            }),
            extra: if id % 7 == 0 {
                object(json!({"image": format!("{id}.png")}))
            } else {
                object(json!({}))
            },
            ..Node::default()
        });
    }
    truth
}

/// The nodes of each landmark edge, and whether the edge is correct: runs of correct edges, then single incorrect ones.
fn pairs(seed: u64) -> Vec<(usize, usize, bool)> {
    let mut pairs: Vec<(usize, usize, bool)> = (0..LAP)
        .filter(|frame| (frame / RUN).is_multiple_of(3))
        // Shift some runs by a few frames, because a correct match need not be at exactly the same position.
        .map(|frame| (frame, LAP + (frame + frame / RUN / 3 % 4) % LAP, true))
        .collect();
    let mut draw = posecut_stage::random(seed, "conformance sample: incorrect edges");
    while pairs.iter().filter(|pair| !pair.2).count() < INCORRECT {
        let (first, second) = (draw.random_range(0..LAP), draw.random_range(0..LAP));
        if first.abs_diff(second) > 20 && first.abs_diff(second) < LAP - 20 {
            pairs.push((first, LAP + second, false));
        }
    }
    pairs
}

fn diagonal<const DOF: usize>(value: f64) -> Vec<f64> {
    (0..DOF).flat_map(|row| (row..DOF).map(move |column| if row == column { value } else { 0.0 })).collect()
}

fn object(value: Value) -> posecut_graph::Extra {
    match value {
        Value::Object(map) => map,
        _ => posecut_graph::Extra::new(),
    }
}

/// The content of a graph's file.
pub fn bytes(graph: &PoseGraph) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    graph.write(&mut bytes)?;
    Ok(bytes)
}

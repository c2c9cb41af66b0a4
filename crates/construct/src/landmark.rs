//! Landmark edges, correct and incorrect, with their measurements.

use nalgebra::SVector;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{Dimension, Edge, EdgeKind, EdgeTruth, Extra, NoiseModel, PoseGraph};
use posecut_stage::{ChaCha8Rng, Statistics, info, random};
use rand::RngExt as _;
use rand_distr::{Distribution, StandardNormal};

use crate::correct::similar_pairs;
use crate::incorrect::{count, random_pairs};
use crate::{ConstructError, Options};

/// A node with truth, as construction sees it.
pub(crate) struct Viewpoint {
    pub(crate) node: u64,
    pub(crate) experience: usize,
    pub(crate) utime: Option<i64>,
    pub(crate) position: [f64; 3],
    pub(crate) heading: f64,
    pose: Vec<f64>,
}

impl Viewpoint {
    pub(crate) fn distance(&self, other: &Self) -> f64 {
        self.position.iter().zip(&other.position).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }
}

/// Adds correct edges between spatially similar viewpoints of different experiences and incorrect ones at
/// the given rate of all. Edges are numbered by their ends, so that an id tells nothing of the truth.
pub fn add_landmark_edges(
    graph: &mut PoseGraph,
    options: &Options,
    statistics: &mut Statistics,
) -> Result<(), ConstructError> {
    match graph.header.dimension {
        Dimension::Two => add::<SE2, 3>(graph, options, statistics, SE2::angle),
        Dimension::Three => add::<SE3, 6>(graph, options, statistics, |pose| pose.to_planar().angle()),
    }
}

fn add<G: LieGroup<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    options: &Options,
    statistics: &mut Statistics,
    heading: impl Fn(&G) -> f64,
) -> Result<(), ConstructError> {
    let viewpoints = viewpoints(graph, heading);
    if viewpoints.is_empty() {
        return Err(ConstructError::NoTruth);
    }
    let correct = similar_pairs(&viewpoints, options);
    if correct.is_empty() {
        return Err(ConstructError::NoOverlap { radius: options.radius, heading: options.heading });
    }
    let mut noise = random(options.seed, "landmark noise");
    let mut edges: Vec<(usize, usize, Vec<f64>, bool)> = Vec::new();
    for &(from, to) in &correct {
        let truth = pose::<G, DOF>(&viewpoints[from]).between(&pose(&viewpoints[to]));
        let measurement = truth.compose(&G::exp(&draw_noise(options, &mut noise)));
        edges.push((from, to, measurement.components(), true));
    }
    let wanted = count(correct.len(), options.incorrect_rate);
    let mut wrong = random(options.seed, "incorrect edges");
    for (from, to) in random_pairs(&viewpoints, wanted, options, &mut wrong)? {
        // The false match claims what correct matches claim: "here, within a few metres".
        let claim = edges[wrong.random_range(0..correct.len())].2.clone();
        edges.push((from, to, claim, false));
    }
    edges.sort_by_key(|&(from, to, ..)| (from, to));
    let name = add_noise_model::<DOF>(graph, options);
    let first = graph.edges.last().map_or(0, |edge| edge.id + 1);
    for (id, (from, to, measurement, correct)) in (first..).zip(edges) {
        let mut edge = Edge::new(EdgeKind::Landmark, id, viewpoints[from].node, viewpoints[to].node);
        edge.measurement = Some(measurement);
        edge.noise = Some(name.clone());
        edge.truth = Some(EdgeTruth { correct: Some(correct), ..EdgeTruth::default() });
        graph.edges.push(edge);
    }
    info!("{} correct landmark edges, {wanted} incorrect", correct.len());
    statistics.note("sessions", graph.sessions());
    statistics.note("nodes", graph.nodes.len());
    statistics.note("nodes_with_truth", viewpoints.len());
    statistics.note("landmark_edges", correct.len() + wanted);
    statistics.note("correct_edges", correct.len());
    statistics.note("incorrect_edges", wanted);
    Ok(())
}

fn viewpoints<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    heading: impl Fn(&G) -> f64,
) -> Vec<Viewpoint> {
    let sessions: Vec<&str> = graph.sessions();
    let mut viewpoints = Vec::new();
    let mut last = (None, 0);
    for node in &graph.nodes {
        let session = node.session.as_deref();
        if last.0 != session {
            let place = sessions.iter().position(|&name| Some(name) == session);
            last = (session, place.unwrap_or(sessions.len()));
        }
        let Some(components) = node.truth.as_ref().and_then(|truth| truth.pose.clone()) else { continue };
        let Some(pose) = G::from_components(&components) else { continue };
        viewpoints.push(Viewpoint {
            node: node.id,
            experience: last.1,
            utime: node.utime,
            position: pose.translation(),
            heading: heading(&pose),
            pose: components,
        });
    }
    viewpoints
}

fn pose<G: LieGroup<DOF>, const DOF: usize>(viewpoint: &Viewpoint) -> G {
    G::from_components(&viewpoint.pose).unwrap_or_else(G::identity)
}

/// Translations per axis of a tangent vector: 2 of 3 in the plane, 3 of 6 in space.
const fn translations(degrees_of_freedom: usize) -> usize {
    if degrees_of_freedom == 3 { 2 } else { 3 }
}

fn sigma<const DOF: usize>(options: &Options, axis: usize) -> f64 {
    if axis < translations(DOF) {
        options.landmark_sigma_translation
    } else {
        options.landmark_sigma_rotation
    }
}

fn draw_noise<const DOF: usize>(options: &Options, random: &mut ChaCha8Rng) -> SVector<f64, DOF> {
    SVector::from_fn(|axis, _| {
        let unit: f64 = StandardNormal.sample(random);
        unit * sigma::<DOF>(options, axis)
    })
}

/// The name of the landmark edges' noise model, free or with the same content.
fn add_noise_model<const DOF: usize>(graph: &mut PoseGraph, options: &Options) -> String {
    let mut information = Vec::new();
    for i in 0..DOF {
        for j in i..DOF {
            let sigma = sigma::<DOF>(options, i);
            information.push(if i == j { 1.0 / (sigma * sigma) } else { 0.0 });
        }
    }
    let model = NoiseModel { information, extra: Extra::new() };
    let mut name = "landmark".to_owned();
    while graph.header.noise_model(&name).is_some_and(|known| *known != model) {
        name.push('+');
    }
    if graph.header.noise_model(&name).is_none() {
        graph.header.noise_models.push((name.clone(), model));
    }
    name
}

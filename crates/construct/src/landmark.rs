//! Landmark edges, correct and incorrect, with their measurements.

use posecut_geometry::{SE2, SE3};
use posecut_graph::{Dimension, Edge, EdgeKind, EdgeTruth, PoseGraph};
use posecut_stage::{Statistics, info, random};

use crate::correct::Similarity;
use crate::incorrect::{FalseMatch, Scene, count, false_matches};
use crate::noise::{add_noise_model, draw_noise};
use crate::viewpoint::{Headed, viewpoints};
use crate::{ConstructError, Options};

/// Adds correct edges between spatially similar viewpoints of different experiences and incorrect ones at
/// the given rate of all. Edges are numbered by their ends, so that an id tells nothing of the truth.
pub fn add_landmark_edges(
    graph: &mut PoseGraph,
    options: &Options,
    statistics: &mut Statistics,
) -> Result<(), ConstructError> {
    match graph.header.dimension {
        Dimension::Two => add::<SE2, 3>(graph, options, statistics),
        Dimension::Three => add::<SE3, 6>(graph, options, statistics),
    }
}

fn add<G: Headed<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    options: &Options,
    statistics: &mut Statistics,
) -> Result<(), ConstructError> {
    let viewpoints = viewpoints::<G, DOF>(graph);
    if viewpoints.is_empty() {
        return Err(ConstructError::NoTruth);
    }
    let correct = Similarity::of(options).pairs(&viewpoints);
    if correct.is_empty() {
        return Err(ConstructError::NoOverlap { radius: options.radius, heading: options.heading });
    }
    let mut noise = random(options.seed, "landmark noise");
    let measure = |&(from, to): &(usize, usize)| {
        let truth = viewpoints[from].pose.between(&viewpoints[to].pose);
        truth.compose(&G::exp(&draw_noise(options, &mut noise)))
    };
    let claims: Vec<G> = correct.iter().map(measure).collect();
    let scene = Scene { viewpoints: &viewpoints, claims: &claims, options };
    let wanted = count(correct.len(), options.incorrect_rate);
    let wrong = false_matches(&scene, wanted, &mut random(options.seed, "incorrect edges"))?;
    let groups = wrong.iter().filter_map(|edge| edge.group).max().map(|last| last + 1);

    let right =
        correct.iter().zip(&claims).map(|(&(from, to), claim)| (from, to, claim, EdgeTruth::of(true)));
    let mut edges: Vec<_> = right
        .chain(wrong.iter().map(|edge| (edge.from, edge.to, &edge.measurement, truth_of(edge))))
        .collect();
    edges.sort_by_key(|&(from, to, ..)| (from, to));
    let name = add_noise_model::<DOF>(graph, options);
    let first = graph.edges.last().map_or(0, |edge| edge.id + 1);
    for (id, (from, to, measurement, truth)) in (first..).zip(edges) {
        let mut edge = Edge::new(EdgeKind::Landmark, id, viewpoints[from].node, viewpoints[to].node);
        edge.measurement = Some(measurement.components());
        edge.noise = Some(name.clone());
        edge.truth = Some(truth);
        graph.edges.push(edge);
    }
    info!("{} correct landmark edges, {wanted} incorrect", correct.len());
    statistics.note("sessions", graph.sessions());
    statistics.note("nodes", graph.nodes.len());
    statistics.note("nodes_with_truth", viewpoints.len());
    statistics.note("landmark_edges", correct.len() + wanted);
    statistics.note("correct_edges", correct.len());
    statistics.note("incorrect_edges", wanted);
    statistics.note("incorrect_kind", options.incorrect_kind);
    if let Some(groups) = groups {
        statistics.note("incorrect_groups", groups);
    }
    Ok(())
}

/// That an edge is incorrect, and which mistake it belongs to.
fn truth_of<G>(edge: &FalseMatch<G>) -> EdgeTruth {
    let mut truth = EdgeTruth::of(false);
    if let Some(group) = edge.group {
        truth.extra.insert("group".to_owned(), group.into());
    }
    truth
}

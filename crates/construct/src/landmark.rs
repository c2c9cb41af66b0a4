//! Landmark edges, correct and incorrect, with their measurements.

use posecut_graph::{Edge, EdgeKind, EdgeTruth, PoseGraph, for_dimension};
use posecut_random::random;
use rand::seq::SliceRandom as _;

use crate::correct::Similarity;
use crate::incorrect::{Claims, FalseMatch, Scene, count, false_matches};
use crate::noise::{add_noise_model, with_noise};
use crate::viewpoint::{Headed, viewpoints};
use crate::{ConstructError, Options};

/// The landmark edges that were added, in numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Nodes with ground truth.
    pub nodes_with_truth: usize,
    /// Added landmark edges.
    pub landmark_edges: usize,
    /// Those that are correct by ground truth.
    pub correct_edges: usize,
    /// Those that are incorrect by ground truth.
    pub incorrect_edges: usize,
    /// Mistakes that made several incorrect edges each; `None` if there are none.
    pub incorrect_groups: Option<usize>,
}

/// Adds correct edges between spatially similar viewpoints of different experiences, and incorrect ones at the given
/// rate. Edges are numbered by their nodes, so that an id does not reveal the truth.
pub fn add_landmark_edges(graph: &mut PoseGraph, options: &Options) -> Result<Counts, ConstructError> {
    for_dimension!(graph.header.dimension, |G, DOF| add::<G, DOF>(graph, options))
}

fn add<G: Headed<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    options: &Options,
) -> Result<Counts, ConstructError> {
    let viewpoints = viewpoints::<G, DOF>(graph);
    if viewpoints.is_empty() {
        return Err(ConstructError::NoTruth);
    }
    let similar = Similarity::of(options).pairs(&viewpoints);
    if similar.is_empty() {
        return Err(ConstructError::NoOverlap { radius: options.radius, heading: options.heading });
    }
    let relative: Vec<G> =
        similar.iter().map(|&(from, to)| viewpoints[from].pose.between(&viewpoints[to].pose)).collect();
    let mut noise = random(options.seed, "landmark noise");
    let measured: Vec<G> = relative.iter().map(|truth| with_noise(truth, options, &mut noise)).collect();
    let chosen = chosen(similar.len(), options)?;
    let scene = Scene { viewpoints: &viewpoints, claims: Claims::of(&relative, options), options };
    let wanted = count(chosen.len(), options.incorrect_rate);
    let wrong = false_matches(&scene, wanted, &mut random(options.seed, "incorrect edges"))?;
    let groups = wrong.iter().filter_map(|edge| edge.group).max().map(|last| last + 1);

    let kept = if options.no_correct_edges { &[][..] } else { &chosen };
    let right = kept.iter().map(|&index| {
        let (from, to) = similar[index];
        (from, to, &measured[index], EdgeTruth::of(true))
    });
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
    Ok(Counts {
        nodes_with_truth: viewpoints.len(),
        landmark_edges: kept.len() + wanted,
        correct_edges: kept.len(),
        incorrect_edges: wanted,
        incorrect_groups: groups,
    })
}

/// Chooses the spatially similar pairs that become correct edges. A smaller choice is a subset of a larger one.
fn chosen(similar: usize, options: &Options) -> Result<Vec<usize>, ConstructError> {
    let mut all: Vec<usize> = (0..similar).collect();
    if let Some(wanted) = options.correct_edges {
        if wanted > similar {
            return Err(ConstructError::TooFewCorrectEdges { wanted, found: similar });
        }
        all.shuffle(&mut random(options.seed, "correct edges"));
        all.truncate(wanted);
    }
    Ok(all)
}

/// The truth of an incorrect edge, with the mistake that it belongs to.
fn truth_of<G>(edge: &FalseMatch<G>) -> EdgeTruth {
    let mut truth = EdgeTruth::of(false);
    if let Some(group) = edge.group {
        truth.extra.insert("group".to_owned(), group.into());
    }
    truth
}

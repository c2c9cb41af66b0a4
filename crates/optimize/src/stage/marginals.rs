//! Covariances in the stage's output.

use nalgebra::SMatrix;
use posecut_geometry::covariance::pack_upper_triangle;
use posecut_graph::{EdgeKind, Extra, PoseGraph};
use posecut_stage::{Statistics, warn};
use serde::Serialize;
use serde_json::Value;

use crate::{Marginals, PoseGroup, Problem, Solution};

/// What `--marginals` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum MarginalsOf {
    /// `predicted_covariance` of the relative pose of its nodes on every landmark edge with a measurement, rejected or not
    Landmark,
    /// `covariance` of the pose on every node, relative to the first node of its component or given its fixed nodes and priors
    Poses,
    /// Both
    All,
}

/// Writes the covariances and overwrites those of an earlier run.
pub(super) fn write<G: PoseGroup<DOF>, const DOF: usize>(
    of: MarginalsOf,
    problem: &Problem<G, DOF>,
    solution: &Solution<G>,
    graph: &mut PoseGraph,
    statistics: &mut Statistics,
) {
    let mut marginals = Marginals::new(problem, &solution.poses, &solution.all_weights());
    if matches!(of, MarginalsOf::Landmark | MarginalsOf::All) {
        let is_asked =
            |edge: &&posecut_graph::Edge| edge.kind == EdgeKind::Landmark && edge.measurement.is_some();
        let index = |id| graph.node_index(id).unwrap_or(usize::MAX);
        let pairs: Vec<_> =
            graph.edges.iter().filter(is_asked).map(|edge| (index(edge.from), index(edge.to))).collect();
        let covariances = marginals.relative(&pairs);
        note("predicted_covariances", &covariances, "landmark edges", statistics);
        for (edge, covariance) in graph.edges.iter_mut().filter(|edge| is_asked(&&**edge)).zip(covariances) {
            // Null if there is no covariance: a missing field would mean that none was requested.
            let value = covariance.map_or(Value::Null, |covariance| pack_upper_triangle(&covariance).into());
            edge.extra.insert("predicted_covariance".to_owned(), value);
        }
    }
    if matches!(of, MarginalsOf::Poses | MarginalsOf::All) {
        let nodes: Vec<_> = (0..graph.nodes.len()).collect();
        let covariances = marginals.poses(&nodes);
        note("covariances", &covariances, "nodes", statistics);
        for (node, covariance) in graph.nodes.iter_mut().zip(covariances) {
            set(&mut node.extra, "covariance", covariance);
        }
    }
    for (node, axis) in marginals.undetermined() {
        warn!(
            "the edges do not determine node {} (component {axis} of its pose): no node or edge that is connected with it gets a \
             covariance",
            graph.nodes[node].id
        );
    }
}

fn note<T>(name: &str, covariances: &[Option<T>], what: &str, statistics: &mut Statistics) {
    let without = covariances.iter().filter(|covariance| covariance.is_none()).count();
    statistics.note(name, covariances.len() - without);
    statistics.note(&format!("{name}_absent"), without);
    if without > 0 {
        warn!(
            "{without} of {} {what} have no covariance: the edges in use do not determine one",
            covariances.len()
        );
    }
}

fn set<const DOF: usize>(extra: &mut Extra, name: &str, covariance: Option<SMatrix<f64, DOF, DOF>>) {
    match covariance {
        Some(covariance) => {
            extra.insert(name.to_owned(), pack_upper_triangle(&covariance).into());
        }
        None => {
            extra.shift_remove(name);
        }
    }
}

//! Optimising a pose graph over its odometry and some of its landmark edges.

use posecut_graph::PoseGraph;
use posecut_optimize::{
    Edge, EdgeKind, Options, PoseGroup, Problem, ProblemError, optimize, residual, stage,
};

use crate::Fit;

/// Share of the cost that a step must promise: chi-square tests need few digits.
const COST_TOLERANCE: f64 = 1e-6;

/// A pose graph taken apart into odometry and landmark edges.
#[derive(Clone, Debug)]
pub struct Parts<G, const DOF: usize> {
    poses: Vec<G>,
    odometry: Vec<Edge<G, DOF>>,
    /// Landmark edges in use, in the order of the graph.
    landmarks: Vec<Edge<G, DOF>>,
    /// Their places among the graph's edges.
    pub places: Vec<usize>,
}

impl<G: PoseGroup<DOF>, const DOF: usize> Parts<G, DOF> {
    /// Takes the edges in use that have a measurement.
    pub fn of(graph: &PoseGraph) -> anyhow::Result<Self> {
        let measured = stage::edges::<G, DOF>(graph)?;
        let poses = graph
            .nodes
            .iter()
            .map(|node| {
                G::from_components(&node.pose_or_identity(graph.header.dimension))
                    .ok_or_else(|| anyhow::anyhow!("node {}: its pose cannot be used", node.id))
            })
            .collect::<anyhow::Result<_>>()?;
        let mut parts = Self { poses, odometry: Vec::new(), landmarks: Vec::new(), places: Vec::new() };
        for (edge, place) in measured.edges.into_iter().zip(measured.places) {
            match edge.kind {
                EdgeKind::Odometry => parts.odometry.push(edge),
                EdgeKind::Landmark => {
                    parts.landmarks.push(edge);
                    parts.places.push(place);
                }
            }
        }
        // All edges at once: what the optimiser refuses is refused here, and `fit` cannot fail.
        parts.problem(&(0..parts.landmarks.len()).collect::<Vec<_>>())?;
        Ok(parts)
    }

    fn problem(&self, landmarks: &[usize]) -> Result<Problem<G, DOF>, ProblemError> {
        let chosen = landmarks.iter().map(|&landmark| self.landmarks[landmark]);
        Problem::new(self.poses.clone(), self.odometry.iter().copied().chain(chosen).collect())
    }

    /// The optimum over the odometry and some landmark edges, by their places in [`Parts::places`].
    ///
    /// Its redundancy is DOF (edges - nodes + connected parts): each part has one node that nothing fixes.
    pub fn fit(&self, landmarks: &[usize]) -> Fit {
        let options = Options { cost_tolerance: COST_TOLERANCE, ..Options::default() };
        let problem = self.problem(landmarks).expect("all edges were checked together in `of`");
        let solution = optimize(&problem, &options);
        let redundancy =
            solution.components.iter().map(|part| DOF * (part.edges + 1).saturating_sub(part.nodes)).sum();
        let residuals = landmarks.iter().map(|&landmark| {
            let edge = &self.landmarks[landmark];
            let error = residual(&edge.measurement, &solution.poses[edge.from], &solution.poses[edge.to]);
            error.dot(&(edge.information * error))
        });
        Fit { chi2: solution.chi2, redundancy, residuals: residuals.collect() }
    }
}

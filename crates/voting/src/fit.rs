//! Optimising a pose graph over its odometry and some of its landmark edges.

use posecut_graph::PoseGraph;
use posecut_optimize::{
    Edge, EdgeKind, Initialisation, Options, PoseGroup, Problem, ProblemError, Solution, optimize, residual,
    stage,
};

use crate::Fit;
use crate::chains::Odometry;

/// Share of the cost that a step must promise: chi-square tests need few digits.
const COST_TOLERANCE: f64 = 1e-6;

/// [`Parts::steps`] of the published code.
const STEPS: usize = 4;

/// Change of chi2, as a share of it, below which chains are not linearised again.
const CHAIN_TOLERANCE: f64 = 1e-3;

/// Most linearisations of the chains.
const ROUNDS: usize = 8;

/// A pose graph taken apart into odometry and landmark edges.
#[derive(Clone, Debug)]
pub struct Parts<G, const DOF: usize> {
    poses: Vec<G>,
    odometry: Vec<Edge<G, DOF>>,
    /// The same as chains, if they can be condensed.
    chains: Option<Odometry<G, DOF>>,
    /// Landmark edges in use, in the order of the graph.
    landmarks: Vec<Edge<G, DOF>>,
    /// Their places among the graph's edges.
    pub places: Vec<usize>,
    /// Steps of an optimisation at most. Edges that so few do not bring below the quantile are taken to disagree.
    pub steps: usize,
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
        let mut parts = Self {
            poses,
            odometry: Vec::new(),
            chains: None,
            landmarks: Vec::new(),
            places: Vec::new(),
            steps: STEPS,
        };
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
        parts.chains = Odometry::new(parts.poses.len(), &parts.odometry);
        Ok(parts)
    }

    fn problem(&self, landmarks: &[usize]) -> Result<Problem<G, DOF>, ProblemError> {
        let chosen = landmarks.iter().map(|&landmark| self.landmarks[landmark]);
        Problem::new(self.poses.clone(), self.odometry.iter().copied().chain(chosen).collect())
    }

    /// The optimum over the odometry and some landmark edges, by their places in [`Parts::places`].
    ///
    /// Its redundancy is DOF (edges - nodes + connected parts): each part has one node that nothing fixes. Nodes that no chosen
    /// edge touches are eliminated first: the time grows with the chosen edges, and little with the graph. With steps
    /// enough the result is that of [`Self::fit_whole`] up to a thousandth of chi2.
    pub fn fit(&self, landmarks: &[usize]) -> Fit {
        let condensed = self.chains.as_ref().and_then(|odometry| self.fit_condensed(odometry, landmarks));
        condensed.unwrap_or_else(|| self.fit_whole(landmarks))
    }

    /// [`Self::fit`] over all nodes together.
    pub fn fit_whole(&self, landmarks: &[usize]) -> Fit {
        let problem = self.problem(landmarks).expect("all edges were checked together in `of`");
        let solution = optimize(&problem, &self.options(Initialisation::Best));
        self.result(landmarks, &solution, |node| node)
    }

    /// Optimises the ends of chains and then linearises the chains again, until chi2 stays. `None` if it does not.
    fn fit_condensed(&self, odometry: &Odometry<G, DOF>, landmarks: &[usize]) -> Option<Fit> {
        let mut stays = vec![false; self.poses.len()];
        for &landmark in landmarks {
            stays[self.landmarks[landmark].from] = true;
            stays[self.landmarks[landmark].to] = true;
        }
        let mut chains = odometry.chains(&mut stays);
        let mut numbers = vec![0; stays.len()];
        let mut poses = Vec::new();
        for node in (0..stays.len()).filter(|&node| stays[node]) {
            numbers[node] = poses.len();
            poses.push(self.poses[node]);
        }
        let renumber = |edge: Edge<G, DOF>| Edge { from: numbers[edge.from], to: numbers[edge.to], ..edge };
        let mut start = Initialisation::Best;
        let mut before = f64::INFINITY;
        for _ in 0..ROUNDS {
            let condensed: Vec<_> =
                chains.iter().map(|chain| chain.condense(odometry)).collect::<Option<_>>()?;
            let edges = condensed.iter().map(|chain| chain.edge);
            let chosen = landmarks.iter().map(|&landmark| self.landmarks[landmark]);
            let problem = Problem::new(poses, edges.chain(chosen).map(renumber).collect()).ok()?;
            let solution = optimize(&problem, &self.options(start));
            if (solution.chi2 - before).abs() <= CHAIN_TOLERANCE * solution.chi2.max(CHAIN_TOLERANCE) {
                return Some(self.result(landmarks, &solution, |node| numbers[node]));
            }
            for (chain, condensed) in chains.iter_mut().zip(&condensed) {
                let ends = solution.poses[numbers[chain.from]].between(&solution.poses[numbers[chain.to]]);
                chain.bend(odometry, condensed, &ends);
            }
            start = Initialisation::Given;
            before = solution.chi2;
            poses = solution.poses;
        }
        None
    }

    /// What the tests need of a solution; `number` is that of a node in it.
    fn result(&self, landmarks: &[usize], solution: &Solution<G>, number: impl Fn(usize) -> usize) -> Fit {
        let redundancy =
            solution.components.iter().map(|part| DOF * (part.edges + 1).saturating_sub(part.nodes)).sum();
        let residuals = landmarks.iter().map(|&landmark| {
            let edge = &self.landmarks[landmark];
            let (from, to) = (&solution.poses[number(edge.from)], &solution.poses[number(edge.to)]);
            let error = residual(&edge.measurement, from, to);
            error.dot(&(edge.information * error))
        });
        Fit { chi2: solution.chi2, redundancy, residuals: residuals.collect() }
    }

    fn options(&self, initialisation: Initialisation) -> Options {
        Options {
            initialisation,
            max_iterations: self.steps,
            cost_tolerance: COST_TOLERANCE,
            ..Options::default()
        }
    }
}

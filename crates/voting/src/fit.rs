//! Optimises a pose graph over its odometry and some of its landmark edges.

use posecut_graph::PoseGraph;
use posecut_graph::connectivity::connected_components;
use posecut_optimize::{
    Edge, EdgeKind, Initialisation, Marginals, Options, PoseGroup, Problem, ProblemError, Solution, optimize,
    pose_graph, residual,
};

use crate::chains::{Chain, Condensed, Odometry};
use crate::forecast::{Forecast, forecast};
use crate::vote::{Fit, Optimiser};

/// The least share of the cost that a step must promise to gain: chi-square tests need few digits.
const COST_TOLERANCE: f64 = 1e-4;

/// The value of [`Parts::steps`] in the published code.
const STEPS: usize = 4;

/// If chi-square changes by less than this share, chains are not linearised again.
const CHAIN_TOLERANCE: f64 = 1e-3;

/// The most linearisations of the chains.
const ROUNDS: usize = 8;

/// A problem over the ends of chains, and the condensed chains.
type Condensation<G, const DOF: usize> = (Result<Problem<G, DOF>, ProblemError>, Vec<Condensed<G, DOF>>);

/// A pose graph split into odometry and landmark edges.
#[derive(Clone, Debug)]
pub struct Parts<G, const DOF: usize> {
    poses: Vec<G>,
    odometry: Vec<Edge<G, DOF>>,
    /// The odometry as chains, if they can be condensed.
    chains: Option<Odometry<G, DOF>>,
    /// Landmark edges in use, in the order of the graph.
    landmarks: Vec<Edge<G, DOF>>,
    /// The indices of the landmark edges among the graph's edges.
    pub places: Vec<usize>,
    /// The most steps of an optimisation. Edges that stay above the quantile after these steps count as inconsistent.
    pub steps: usize,
}

/// The current state of an optimisation over the nodes that landmark edges touch.
#[derive(Clone, Debug)]
pub struct State<G> {
    poses: Vec<G>,
    chains: Vec<Chain<G>>,
    /// For each node of the graph that has one of these poses: the index of the pose.
    numbers: Vec<usize>,
    /// The connected component of each pose; `None` before the first optimisation.
    components: Option<Vec<usize>>,
}

impl<G: PoseGroup<DOF>, const DOF: usize> Optimiser for Parts<G, DOF> {
    type State = Option<State<G>>;

    fn fit(&self, landmarks: &[usize]) -> Fit {
        self.fit(landmarks)
    }

    fn state(&self, landmarks: &[usize]) -> Self::State {
        self.state(landmarks)
    }

    fn refit(&self, state: &Self::State, landmarks: &[usize]) -> (Fit, Self::State) {
        let mut next = state.clone();
        let settled = next.as_mut().and_then(|next| self.settle(next, landmarks));
        settled.map_or_else(|| (self.fit_whole(landmarks), state.clone()), |fit| (fit, next))
    }

    /// Costs one factorisation, and a few triangular solves for each waiting edge.
    fn forecast(&self, state: &Self::State, accepted: &[usize], waiting: &[usize]) -> Vec<Option<Forecast>> {
        let problem = state.as_ref().and_then(|state| self.condensed(state, accepted)?.0.ok());
        let Some((State { poses, numbers, .. }, problem)) = state.as_ref().zip(problem) else {
            return vec![None; waiting.len()];
        };
        let edges = waiting.iter().map(|&landmark| &self.landmarks[landmark]);
        let pairs: Vec<_> = edges.clone().map(|edge| (numbers[edge.from], numbers[edge.to])).collect();
        let covariances = Marginals::new(&problem, poses, &[]).relative(&pairs);
        let forecasts = edges.zip(pairs).zip(covariances).map(|((edge, (from, to)), covariance)| {
            let error = residual(&edge.measurement, &poses[from], &poses[to]);
            forecast(&error, &edge.information, &G::right_jacobian_inverse(&error), &covariance?)
        });
        forecasts.collect()
    }
}

impl<G: PoseGroup<DOF>, const DOF: usize> Parts<G, DOF> {
    /// Splits a graph. Only edges in use that have a measurement count.
    pub fn of(graph: &PoseGraph) -> anyhow::Result<Self> {
        let measured = pose_graph::edges::<G, DOF>(graph)?;
        let poses = graph.poses::<G, DOF>()?;
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
        // Checks all edges at once: the optimiser's errors appear here, and `fit` cannot fail.
        parts.problem(&(0..parts.landmarks.len()).collect::<Vec<_>>())?;
        parts.chains = Odometry::new(parts.poses.len(), &parts.odometry);
        Ok(parts)
    }

    fn problem(&self, landmarks: &[usize]) -> Result<Problem<G, DOF>, ProblemError> {
        let chosen = landmarks.iter().map(|&landmark| self.landmarks[landmark]);
        Problem::new(self.poses.clone(), self.odometry.iter().copied().chain(chosen).collect())
    }

    /// The optimum over the odometry and some landmark edges, given by their indices in [`Parts::places`].
    ///
    /// Its redundancy is DOF (edges - nodes + connected components), because each component has one node that nothing
    /// fixes. Nodes that no chosen edge touches are eliminated first, so that the time depends on the number of chosen
    /// edges and little on the size of the graph. With enough steps the result is that of [`Self::fit_whole`] up to a
    /// thousandth of chi-square.
    pub fn fit(&self, landmarks: &[usize]) -> Fit {
        let settled = self.state(landmarks).and_then(|mut state| self.settle(&mut state, landmarks));
        settled.unwrap_or_else(|| self.fit_whole(landmarks))
    }

    /// As [`Self::fit`], but over all nodes together.
    pub fn fit_whole(&self, landmarks: &[usize]) -> Fit {
        let problem = self.problem(landmarks).expect("all edges were checked together in `of`");
        let solution = optimize(&problem, &self.options(Initialisation::Best));
        let nodes: Vec<usize> = (0..self.poses.len()).collect();
        self.result(landmarks, &solution, &nodes)
    }

    /// The nodes that these landmark edges touch, and the chains between them; `None` if chains cannot be condensed.
    fn state(&self, landmarks: &[usize]) -> Option<State<G>> {
        let mut stays = vec![false; self.poses.len()];
        for &landmark in landmarks {
            stays[self.landmarks[landmark].from] = true;
            stays[self.landmarks[landmark].to] = true;
        }
        let chains = self.chains.as_ref()?.chains(&mut stays);
        let mut numbers = vec![0; stays.len()];
        let mut poses = Vec::new();
        for node in (0..stays.len()).filter(|&node| stays[node]) {
            numbers[node] = poses.len();
            poses.push(self.poses[node]);
        }
        Some(State { poses, chains, numbers, components: None })
    }

    /// The problem over the ends of chains, and the chains as edges; `None` if a chain has no information matrix.
    fn condensed(&self, state: &State<G>, landmarks: &[usize]) -> Option<Condensation<G, DOF>> {
        let odometry = self.chains.as_ref()?;
        let condensed: Vec<_> =
            state.chains.iter().map(|chain| chain.condense(odometry)).collect::<Option<_>>()?;
        let chosen = landmarks.iter().map(|&landmark| self.landmarks[landmark]);
        let edges = condensed.iter().map(|chain| chain.edge).chain(chosen).map(|edge| Edge {
            from: state.numbers[edge.from],
            to: state.numbers[edge.to],
            ..edge
        });
        Some((Problem::new(state.poses.clone(), edges.collect()), condensed))
    }

    /// Optimises the ends of chains, then linearises the chains again, until chi-square converges. `None` if it does not
    /// converge.
    ///
    /// Starts from the poses of the state, unless a landmark edge joins components that were separate.
    fn settle(&self, state: &mut State<G>, landmarks: &[usize]) -> Option<Fit> {
        let odometry = self.chains.as_ref()?;
        let joined = |components: &Vec<usize>| {
            landmarks
                .iter()
                .map(|&landmark| &self.landmarks[landmark])
                .all(|edge| components[state.numbers[edge.from]] == components[state.numbers[edge.to]])
        };
        let mut start = match &state.components {
            Some(components) if joined(components) => Initialisation::Given,
            _ => Initialisation::Best,
        };
        let mut before = f64::INFINITY;
        for _ in 0..ROUNDS {
            let (problem, condensed) = self.condensed(state, landmarks)?;
            let problem = problem.ok()?;
            let mut solution = optimize(&problem, &self.options(start));
            // From far away the steps may not suffice; another start is then better.
            if start == Initialisation::Given && before.is_infinite() && !solution.converged {
                solution = optimize(&problem, &self.options(Initialisation::Best));
            }
            for (chain, condensed) in state.chains.iter_mut().zip(&condensed) {
                let [from, to] = [chain.from, chain.to].map(|node| solution.poses[state.numbers[node]]);
                chain.bend(odometry, condensed, &from.between(&to));
            }
            let moved = (solution.chi_square - before).abs();
            let settled = moved <= CHAIN_TOLERANCE * solution.chi_square.max(CHAIN_TOLERANCE);
            if settled || solution.converged && state.chains.iter().all(Chain::is_edge) {
                let fit = self.result(landmarks, &solution, &state.numbers);
                let mut components = vec![0; solution.poses.len()];
                let ends = problem.edges().iter().map(|edge| (edge.from, edge.to));
                for (number, component) in connected_components(components.len(), ends).iter().enumerate() {
                    component.nodes.iter().for_each(|&node| components[node] = number);
                }
                state.components = Some(components);
                state.poses = solution.poses;
                return Some(fit);
            }
            start = Initialisation::Given;
            before = solution.chi_square;
            state.poses = solution.poses;
        }
        None
    }

    /// The results that the tests need; `numbers` maps nodes to the poses of the solution.
    fn result(&self, landmarks: &[usize], solution: &Solution<G>, numbers: &[usize]) -> Fit {
        let redundancy =
            solution.components.iter().map(|part| DOF * (part.edges + 1).saturating_sub(part.nodes)).sum();
        let residuals = landmarks.iter().map(|&landmark| {
            let edge = &self.landmarks[landmark];
            let [from, to] = [edge.from, edge.to].map(|node| &solution.poses[numbers[node]]);
            let error = residual(&edge.measurement, from, to);
            error.dot(&(edge.information * error))
        });
        Fit { chi_square: solution.chi_square, redundancy, residuals: residuals.collect() }
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

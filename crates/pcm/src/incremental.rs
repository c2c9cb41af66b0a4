//! PCM with candidates that arrive one by one.

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;

use crate::clique::{BitGraph, BitSet, Limits, larger_clique};
use crate::odometry::chain::Chain;
use crate::pairs::candidate::Candidate;
use crate::pairs::consistency::{squared_distance, squared_distance_to_odometry};

/// The effect of one more candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Update {
    /// The candidate's number, counted from 0 in the order of arrival.
    pub candidate: usize,
    /// The number of earlier candidates that it agrees with.
    pub degree: usize,
    /// Whether the largest consistent set changed.
    pub clique_changed: bool,
}

/// The largest consistent set of the candidates between two chains, kept up to date.
///
/// A new candidate costs one row of the consistency graph, O(N) pairs. The search covers only its neighbours, and only if
/// their number and degrees leave room for a larger clique. A candidate that agrees with the whole clique joins it at once.
/// If the clique was proved optimal, it stays so unless a limit ends a search.
///
/// ```
/// use nalgebra::{Matrix3, Vector3};
/// use posecut_geometry::{LieGroup as _, SE2};
/// use posecut_pcm::chain::Chain;
/// use posecut_pcm::clique::Limits;
/// use posecut_pcm::incremental::Incremental;
///
/// let step = SE2::new(1.0, 0.0, 0.0);
/// let noise = Matrix3::from_diagonal(&Vector3::new(0.01, 0.01, 0.001));
/// let mut chain = Chain::default();
/// for _ in 0..10 {
///     chain.push(&step, &noise);
/// }
/// // Two sessions along the same way; a squared distance of 11.345 is chi-square at 0.99 with 3 degrees of freedom.
/// let mut pcm = Incremental::new(chain.clone(), chain, 11.345, Limits::NONE);
/// let here = SE2::identity();
/// pcm.add(1, 1, &here, &noise);
/// pcm.add(5, 9, &here, &noise); // claims that places four metres apart are one
/// let update = pcm.add(6, 6, &here, &noise);
/// assert_eq!((update.candidate, update.degree), (2, 1));
/// assert_eq!(pcm.clique(), [0, 2]);
/// // The robot drives on, and another candidate arrives.
/// pcm.drive_a(&step, &noise);
/// pcm.drive_b(&step, &noise);
/// assert!(pcm.add(11, 11, &here, &noise).clique_changed);
/// assert_eq!((pcm.clique(), pcm.upper_bound()), (&[0, 2, 3][..], 3));
/// ```
#[derive(Clone, Debug)]
pub struct Incremental<G, const DOF: usize> {
    chain_a: Chain<G, DOF>,
    /// `None` if both ends of a candidate lie in chain A.
    chain_b: Option<Chain<G, DOF>>,
    candidates: Vec<Candidate<G, DOF>>,
    gate: f64,
    limits: Limits,
    graph: BitGraph,
    degrees: Vec<usize>,
    /// For each candidate: whether it agrees with the odometry alone. Between two chains every candidate does.
    admissible: Vec<bool>,
    clique: Vec<usize>,
    upper_bound: usize,
}

impl<G: LieGroup<DOF>, const DOF: usize> Incremental<G, DOF> {
    /// Starts without candidates between two chains. `gate` is the largest squared Mahalanobis distance of a consistent
    /// pair; `limits` apply to each search.
    pub fn new(chain_a: Chain<G, DOF>, chain_b: Chain<G, DOF>, gate: f64, limits: Limits) -> Self {
        Self::with(chain_a, Some(chain_b), gate, limits)
    }

    /// Starts without candidates within one chain.
    pub fn within(chain: Chain<G, DOF>, gate: f64, limits: Limits) -> Self {
        Self::with(chain, None, gate, limits)
    }

    fn with(chain_a: Chain<G, DOF>, chain_b: Option<Chain<G, DOF>>, gate: f64, limits: Limits) -> Self {
        Self {
            chain_a,
            chain_b,
            candidates: Vec::new(),
            gate,
            limits,
            graph: BitGraph::default(),
            degrees: Vec::new(),
            admissible: Vec::new(),
            clique: Vec::new(),
            upper_bound: 0,
        }
    }

    /// Lengthens chain A by a step.
    pub fn drive_a(&mut self, motion: &G, covariance: &SMatrix<f64, DOF, DOF>) {
        self.chain_a.push(motion, covariance);
    }

    /// Lengthens chain B by a step, or the only chain if there is just one.
    pub fn drive_b(&mut self, motion: &G, covariance: &SMatrix<f64, DOF, DOF>) {
        self.chain_b.as_mut().unwrap_or(&mut self.chain_a).push(motion, covariance);
    }

    /// Adds a candidate from index `i` of chain A to index `k` of chain B (within one chain, `i` before `k`). It measures
    /// the pose of the second node in the frame of the first.
    ///
    /// # Panics
    ///
    /// If an index lies beyond the end of its chain.
    pub fn add(
        &mut self,
        i: usize,
        k: usize,
        measurement: &G,
        covariance: &SMatrix<f64, DOF, DOF>,
    ) -> Update {
        let same_chain = self.chain_b.is_none();
        let chain_b = self.chain_b.as_ref().unwrap_or(&self.chain_a);
        let vertex = self.graph.add_vertex();
        let candidate = Candidate::new(vertex, (&self.chain_a, i), (chain_b, k), measurement, covariance);
        self.degrees.push(0);
        let admissible = !same_chain
            || squared_distance_to_odometry(&self.chain_a, &candidate)
                .is_some_and(|distance| distance <= self.gate);
        self.admissible.push(admissible);
        for (other, earlier) in self.candidates.iter().enumerate() {
            if !admissible || !self.admissible[other] {
                continue;
            }
            let distance = squared_distance(&self.chain_a, chain_b, same_chain, earlier, &candidate);
            if distance.is_some_and(|distance| distance <= self.gate) {
                self.graph.connect(other, vertex);
                self.degrees[other] += 1;
                self.degrees[vertex] += 1;
            }
        }
        self.candidates.push(candidate);
        let clique_changed = admissible && self.improve(vertex);
        Update { candidate: vertex, degree: self.degrees[vertex], clique_changed }
    }

    /// The largest consistent set known, ascending.
    pub fn clique(&self) -> &[usize] {
        &self.clique
    }

    /// No consistent set is larger than this. The clique is proved optimal if it has as many members.
    pub fn upper_bound(&self) -> usize {
        self.upper_bound
    }

    /// The consistency graph so far.
    pub fn graph(&self) -> &BitGraph {
        &self.graph
    }

    /// Searches for a larger clique, which must contain the new vertex.
    fn improve(&mut self, vertex: usize) -> bool {
        let size = self.clique.len();
        if self.clique.iter().all(|&member| self.graph.connected(member, vertex)) {
            self.clique.push(vertex);
            self.upper_bound = (self.upper_bound + 1).max(self.clique.len());
            // One vertex adds at most one to the size, so a clique that was proved optimal still is.
            return true;
        }
        let mut neighbours = BitSet::new(self.graph.len());
        let mut count = 0;
        for other in 0..vertex {
            if self.graph.connected(other, vertex) && self.degrees[other] >= size {
                neighbours.insert(other);
                count += 1;
            }
        }
        if count < size {
            return false;
        }
        let outcome = larger_clique(&self.graph, &neighbours, size - 1, self.limits);
        // The first bound covers cliques with the new vertex; the old bound covers those without it.
        self.upper_bound = self.upper_bound.max((outcome.upper_bound + 1).min(self.upper_bound + 1));
        let Some(mut clique) = outcome.clique else { return false };
        clique.push(vertex);
        clique.sort_unstable();
        self.clique = clique;
        self.upper_bound = self.upper_bound.max(self.clique.len());
        true
    }
}

//! The vote on clusters and its chi-square tests.

use posecut_pcm::{Gate, PcmError, Test};
use rayon::prelude::*;

use crate::election::{Ballot, Election};
use crate::forecast::Forecast;

/// The optimum over the odometry and some landmark edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Sum of squared Mahalanobis residuals of all edges.
    pub chi_square: f64,
    /// Degrees of freedom of that sum: components of residuals minus those of poses.
    pub redundancy: usize,
    /// Squared Mahalanobis residual of each requested landmark edge, in that order.
    pub residuals: Vec<f64>,
}

/// A problem that can be optimised over a choice of landmark edges.
pub trait Optimiser: Sync {
    /// The state from which an optimisation starts.
    type State: Clone;

    /// The optimum over the odometry and these landmark edges.
    fn fit(&self, landmarks: &[usize]) -> Fit;

    /// A state from which optimisations over any choice of these landmark edges may start.
    fn state(&self, landmarks: &[usize]) -> Self::State;

    /// The optimum over these landmark edges, started from the state of an optimum over fewer. Also returns the new state.
    fn refit(&self, state: &Self::State, landmarks: &[usize]) -> (Fit, Self::State);

    /// The effect of each waiting edge on the optimum over the accepted ones; `None` if it is not known.
    fn forecast(&self, state: &Self::State, accepted: &[usize], waiting: &[usize]) -> Vec<Option<Forecast>>;
}

impl<F: Fn(&[usize]) -> Fit + Sync> Optimiser for F {
    type State = ();

    fn fit(&self, landmarks: &[usize]) -> Fit {
        self(landmarks)
    }

    fn state(&self, _landmarks: &[usize]) {}

    fn refit(&self, _state: &(), landmarks: &[usize]) -> (Fit, ()) {
        (self(landmarks), ())
    }

    fn forecast(&self, _state: &(), _accepted: &[usize], waiting: &[usize]) -> Vec<Option<Forecast>> {
        vec![None; waiting.len()]
    }
}

/// Chi-square quantiles at one probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantiles {
    probability: f64,
    /// Components of the residual of one edge.
    edge_degrees: usize,
}

impl Quantiles {
    /// `edge_degrees` is 3 in the plane and 6 in space; the probability must lie in (0, 1).
    pub fn new(probability: f64, edge_degrees: usize) -> Result<Self, PcmError> {
        Gate::new(Test::Mahalanobis, probability, edge_degrees)?;
        Ok(Self { probability, edge_degrees })
    }

    /// The quantile for this many degrees of freedom; infinite for none, because then there is nothing to test.
    fn at(self, degrees: usize) -> f64 {
        let gate = Gate::new(Test::Mahalanobis, self.probability, degrees);
        gate.map_or(f64::INFINITY, |gate| gate.squared_distance)
    }

    pub(crate) fn edges(self, count: usize) -> f64 {
        self.at(count * self.edge_degrees)
    }

    pub(crate) fn passes(self, fit: &Fit) -> bool {
        fit.redundancy == 0 || fit.chi_square < self.at(fit.redundancy)
    }

    /// How much chi-square may still grow with this many more edges.
    pub(crate) fn slack(self, fit: &Fit, edges: usize) -> f64 {
        self.at(fit.redundancy + edges * self.edge_degrees) - fit.chi_square
    }
}

/// The outcome of a vote.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// Landmark edges kept, ascending.
    pub kept: Vec<usize>,
    /// Clusters that passed by themselves.
    pub clusters_consistent: usize,
    /// Clusters kept in the end.
    pub clusters_kept: usize,
    /// Optimisations done.
    pub fits: usize,
    /// Clusters rejected without an optimisation, because a forecast from the last optimum rules them out.
    pub foreseen: usize,
}

/// Votes on clusters of landmark edges.
///
/// First, each cluster is tested alone (algorithm 1 of the paper). While chi-square of its optimum fails, the edge of
/// largest residual is removed, until none remains; then the edges whose own residual fails. Second, the [`Election`]
/// decides among the remaining clusters.
///
/// Two things differ from the published code. The test of the whole uses the redundancy of the graph as degrees of freedom,
/// not the number of all edges: without loops, thousands of odometry edges have zero residuals, and counting them would
/// leave room for any false loop. And a cluster that fails loses its worst edge, not all edges: here a cluster is as long
/// as frames stay near each other, and one false edge next to a run of a hundred would remove them all.
///
/// This takes one optimisation for each cluster and for each edge removed from one (clusters in parallel), then those of
/// the election.
pub fn vote(
    clusters: &[Vec<usize>],
    quantiles: Quantiles,
    election: Election,
    optimiser: &impl Optimiser,
) -> Verdict {
    let parts: Vec<(Vec<usize>, usize)> =
        clusters.par_iter().map(|cluster| consistent_part(cluster, quantiles, optimiser)).collect();
    let fits = parts.iter().map(|(_, fits)| fits).sum();
    let consistent: Vec<Vec<usize>> =
        parts.into_iter().map(|(cluster, _)| cluster).filter(|cluster| !cluster.is_empty()).collect();
    let mut ballot = Ballot { clusters: &consistent, quantiles, optimiser, fits, foreseen: 0 };
    let accepted = ballot.hold(election);
    let mut kept: Vec<usize> = accepted.iter().flat_map(|&cluster| consistent[cluster].clone()).collect();
    kept.sort_unstable();
    Verdict {
        kept,
        clusters_consistent: consistent.len(),
        clusters_kept: accepted.len(),
        fits: ballot.fits,
        foreseen: ballot.foreseen,
    }
}

/// The edges of a cluster that pass by themselves, and the number of optimisations needed.
fn consistent_part(
    cluster: &[usize],
    quantiles: Quantiles,
    optimiser: &impl Optimiser,
) -> (Vec<usize>, usize) {
    let mut members = cluster.to_vec();
    let mut state = optimiser.state(&members);
    let mut fits = 0;
    while !members.is_empty() {
        let (found, next) = optimiser.refit(&state, &members);
        state = next;
        fits += 1;
        if quantiles.passes(&found) {
            let bound = quantiles.edges(1);
            let mut residuals = found.residuals.iter();
            members.retain(|_| residuals.next().is_some_and(|&residual| residual < bound));
            break;
        }
        members = without_worst(&members, &found.residuals, quantiles.edges(1));
    }
    (members, fits)
}

/// A cluster without its edge of largest residual. A large cluster loses up to one edge in 128 at once, if their own
/// residuals fail.
fn without_worst(members: &[usize], residuals: &[f64], bound: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..members.len()).collect();
    order.sort_by(|&a, &b| residuals[b].total_cmp(&residuals[a]));
    let failing = order.iter().filter(|&&place| residuals[place] >= bound).count();
    let out = &mut order[..failing.min(members.len() / AT_ONCE).max(1)];
    out.sort_unstable();
    let stays = |(place, &member)| out.binary_search(&place).is_err().then_some(member);
    members.iter().enumerate().filter_map(stays).collect()
}

/// A cluster loses at most one edge in this many at once, but at least one.
const AT_ONCE: usize = 128;

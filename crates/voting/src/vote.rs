//! Which clusters pass the chi-square tests.

use posecut_pcm::{Gate, PcmError, Test};
use rayon::prelude::*;

use crate::election::{Ballot, Election};

/// The optimum over the odometry and some landmark edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Sum of squared Mahalanobis residuals of all edges.
    pub chi2: f64,
    /// Degrees of freedom of that sum: components of residuals less those of poses.
    pub redundancy: usize,
    /// Squared Mahalanobis residual of each landmark edge asked for, in that order.
    pub residuals: Vec<f64>,
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

    /// The quantile with so many degrees of freedom; no sum of no squares is too large.
    fn at(self, degrees: usize) -> f64 {
        let gate = Gate::new(Test::Mahalanobis, self.probability, degrees);
        gate.map_or(f64::INFINITY, |gate| gate.squared_distance)
    }

    pub(crate) fn edges(self, count: usize) -> f64 {
        self.at(count * self.edge_degrees)
    }

    pub(crate) fn passes(self, fit: &Fit) -> bool {
        fit.redundancy == 0 || fit.chi2 < self.at(fit.redundancy)
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
}

/// Votes on clusters of landmark edges. `fit` optimises over the odometry and the edges that it is given.
///
/// First each cluster alone (algorithm 1 of the paper): while chi2 of its optimum fails, the edge of the largest residual is
/// taken out, until none is left; then those edges whose own residual fails. Then the [`Election`] of what is left.
///
/// Two things differ from the published code. The test of the whole takes the redundancy of the graph as degrees of freedom,
/// not the number of all edges: with the latter, thousands of odometry edges, whose residuals are zero without loops, would
/// leave room for any false loop. And a cluster that fails loses its worst edge, not all: clusters here are as long as frames
/// stay near each other, and one false edge beside a run of a hundred would take them along.
///
/// One optimisation for each cluster and each edge taken out of it (clusters in parallel), then those of the election.
pub fn vote(
    clusters: &[Vec<usize>],
    quantiles: Quantiles,
    election: Election,
    fit: impl Fn(&[usize]) -> Fit + Sync,
) -> Verdict {
    let parts: Vec<(Vec<usize>, usize)> =
        clusters.par_iter().map(|cluster| consistent_part(cluster, quantiles, &fit)).collect();
    let fits = parts.iter().map(|(_, fits)| fits).sum();
    let consistent: Vec<Vec<usize>> =
        parts.into_iter().map(|(cluster, _)| cluster).filter(|cluster| !cluster.is_empty()).collect();
    let mut ballot = Ballot { clusters: &consistent, quantiles, fit, fits };
    let accepted = ballot.hold(election);
    let mut kept: Vec<usize> = accepted.iter().flat_map(|&cluster| consistent[cluster].clone()).collect();
    kept.sort_unstable();
    Verdict { kept, clusters_consistent: consistent.len(), clusters_kept: accepted.len(), fits: ballot.fits }
}

/// The edges of a cluster that pass by themselves, and the optimisations that it took to know.
fn consistent_part(
    cluster: &[usize],
    quantiles: Quantiles,
    fit: impl Fn(&[usize]) -> Fit,
) -> (Vec<usize>, usize) {
    let mut members = cluster.to_vec();
    let mut fits = 0;
    while !members.is_empty() {
        let found = fit(&members);
        fits += 1;
        if quantiles.passes(&found) {
            let bound = quantiles.edges(1);
            let mut residuals = found.residuals.iter();
            members.retain(|_| residuals.next().is_some_and(|&residual| residual < bound));
            break;
        }
        let residuals = found.residuals.iter().enumerate();
        let worst = residuals.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(place, _)| place);
        members.remove(worst);
    }
    (members, fits)
}

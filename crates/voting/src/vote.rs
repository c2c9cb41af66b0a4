//! Which clusters pass the chi-square tests.

use std::collections::BTreeSet;

use posecut_pcm::{Gate, PcmError, Test};
use rayon::prelude::*;

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

    fn edges(self, count: usize) -> f64 {
        self.at(count * self.edge_degrees)
    }

    fn passes(self, fit: &Fit) -> bool {
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

/// Votes on clusters of landmark edges (algorithms 1 to 3 of the paper). `fit` optimises over the odometry and the edges
/// that it is given.
///
/// 1. Each cluster alone: while chi2 of its optimum fails, the edge of the largest residual is taken out, until none is left;
///    then those edges whose own residual fails.
/// 2. All clusters that are left, together: those with one edge at least that passes become candidates.
/// 3. The accepted clusters with the candidates: if the whole and every cluster pass, the candidates are accepted; otherwise
///    the cluster whose residuals exceed their quantile by the largest factor is rejected, and the rest is tried again.
/// 4. Steps 2 and 3 repeat: what was rejected gets another chance after every success, until nothing new is accepted.
///
/// Two things differ from the published code. The test of the whole takes the redundancy of the graph as degrees of freedom,
/// not the number of all edges: with the latter, thousands of odometry edges, whose residuals are zero without loops, would
/// leave room for any false loop. And a cluster that fails loses its worst edge, not all: clusters here are as long as frames
/// stay near each other, and one false edge beside a run of a hundred would take them along.
///
/// One optimisation for each cluster and each edge taken out of it (clusters in parallel), then at most one for each rejection
/// in each round.
pub fn vote(clusters: &[Vec<usize>], quantiles: Quantiles, fit: impl Fn(&[usize]) -> Fit + Sync) -> Verdict {
    let parts: Vec<(Vec<usize>, usize)> =
        clusters.par_iter().map(|cluster| consistent_part(cluster, quantiles, &fit)).collect();
    let fits = parts.iter().map(|(_, fits)| fits).sum();
    let consistent: Vec<Vec<usize>> =
        parts.into_iter().map(|(cluster, _)| cluster).filter(|cluster| !cluster.is_empty()).collect();
    let mut election = Election { clusters: &consistent, quantiles, fit, fits };
    let mut accepted: BTreeSet<usize> = BTreeSet::new();
    let mut refused: BTreeSet<usize> = BTreeSet::new();
    loop {
        let candidates = election.candidates(&accepted, &refused);
        if candidates.is_empty() {
            break;
        }
        let chosen = election.joint(&accepted, &candidates);
        if chosen.len() > accepted.len() {
            // What was rejected next to something false may fit now; what this round rejected does not.
            refused = candidates.difference(&chosen).copied().collect();
            accepted = chosen;
        } else {
            refused.extend(candidates);
        }
    }
    let mut kept: Vec<usize> = accepted.iter().flat_map(|&cluster| consistent[cluster].clone()).collect();
    kept.sort_unstable();
    Verdict {
        kept,
        clusters_consistent: consistent.len(),
        clusters_kept: accepted.len(),
        fits: election.fits,
    }
}

/// Step 1: the edges of a cluster that pass by themselves, and the optimisations that it took to know.
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

struct Election<'a, F> {
    clusters: &'a [Vec<usize>],
    quantiles: Quantiles,
    fit: F,
    fits: usize,
}

impl<F: Fn(&[usize]) -> Fit> Election<'_, F> {
    /// Optimises over clusters; returns also the residuals of each cluster, in their order.
    fn fit(&mut self, chosen: &BTreeSet<usize>) -> (Fit, Vec<Vec<f64>>) {
        let edges: Vec<usize> = chosen.iter().flat_map(|&cluster| self.clusters[cluster].clone()).collect();
        self.fits += 1;
        let fit = (self.fit)(&edges);
        let mut rest = fit.residuals.as_slice();
        let mut by_cluster = Vec::with_capacity(chosen.len());
        for &cluster in chosen {
            let (own, others) = rest.split_at(self.clusters[cluster].len());
            by_cluster.push(own.to_vec());
            rest = others;
        }
        (fit, by_cluster)
    }

    /// Step 2: the clusters neither accepted nor refused that have an edge that passes when all are optimised together.
    fn candidates(&mut self, accepted: &BTreeSet<usize>, refused: &BTreeSet<usize>) -> BTreeSet<usize> {
        let open: BTreeSet<usize> =
            (0..self.clusters.len()).filter(|cluster| !refused.contains(cluster)).collect();
        if open.len() == accepted.len() {
            return BTreeSet::new();
        }
        let bound = self.quantiles.edges(1);
        let (_, residuals) = self.fit(&open);
        open.iter()
            .zip(residuals)
            .filter(|(cluster, residuals)| {
                !accepted.contains(cluster) && residuals.iter().any(|&residual| residual < bound)
            })
            .map(|(&cluster, _)| cluster)
            .collect()
    }

    /// Step 3: the accepted clusters and those candidates that pass together with them.
    fn joint(&mut self, accepted: &BTreeSet<usize>, candidates: &BTreeSet<usize>) -> BTreeSet<usize> {
        let mut chosen: BTreeSet<usize> = accepted.union(candidates).copied().collect();
        while chosen.len() > accepted.len() {
            let (fit, residuals) = self.fit(&chosen);
            // How far each cluster exceeds its quantile: the paper's consistency index.
            let excess =
                |residuals: &[f64]| residuals.iter().sum::<f64>() / self.quantiles.edges(residuals.len());
            let all_pass = residuals.iter().all(|residuals| excess(residuals) < 1.0);
            if all_pass && self.quantiles.passes(&fit) {
                break;
            }
            let worst = chosen
                .iter()
                .zip(&residuals)
                .filter(|(cluster, _)| !accepted.contains(cluster))
                .max_by(|(_, a), (_, b)| excess(a).total_cmp(&excess(b)));
            let Some((&worst, _)) = worst else { break };
            chosen.remove(&worst);
        }
        chosen
    }
}

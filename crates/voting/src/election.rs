//! The order in which clusters that pass by themselves are combined, and which of them are kept.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::forecast::Forecast;
use crate::vote::Optimiser;
use crate::{Fit, Quantiles};

/// The order in which clusters are accepted.
///
/// Largest first costs about one optimisation a refused cluster and a logarithm of those accepted; all together, at most one
/// for each rejection in each round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Election {
    /// Largest first: accept each cluster with which all tests still pass
    LargestFirst,
    /// All together: remove the worst cluster until the rest passes (RRR)
    Joint,
}

/// Clusters, and the tests that they must pass together.
pub(crate) struct Ballot<'a, O> {
    pub clusters: &'a [Vec<usize>],
    pub quantiles: Quantiles,
    pub optimiser: &'a O,
    /// Optimisations done so far.
    pub fits: usize,
    /// Clusters rejected without an optimisation so far.
    pub foreseen: usize,
}

/// The number of rejections after which forecasts for all waiting clusters are worth their cost.
const REFUSALS: usize = 8;

/// A forecast must exceed a quantile by this factor to reject a cluster, because forecasts are of first order.
const BEYOND: f64 = 2.0;

impl<O: Optimiser> Ballot<'_, O> {
    /// The clusters that are elected.
    pub(crate) fn hold(&mut self, election: Election) -> BTreeSet<usize> {
        match election {
            Election::LargestFirst => self.largest_first(),
            Election::Joint => self.joint_rounds(),
        }
    }

    fn edges<'c>(&self, clusters: impl IntoIterator<Item = &'c usize>) -> Vec<usize> {
        clusters.into_iter().flat_map(|&cluster| self.clusters[cluster].clone()).collect()
    }

    /// Optimises over clusters. Also returns the residuals of each cluster, in their order.
    fn fit(&mut self, chosen: &BTreeSet<usize>) -> (Fit, Vec<Vec<f64>>) {
        let edges = self.edges(chosen);
        self.fits += 1;
        let fit = self.optimiser.fit(&edges);
        let residuals = self.by_cluster(chosen, &fit);
        (fit, residuals)
    }

    /// The residuals of each cluster.
    fn by_cluster(&self, chosen: &BTreeSet<usize>, fit: &Fit) -> Vec<Vec<f64>> {
        let mut rest = fit.residuals.as_slice();
        let mut by_cluster = Vec::with_capacity(chosen.len());
        for &cluster in chosen {
            let (own, others) = rest.split_at(self.clusters[cluster].len());
            by_cluster.push(own.to_vec());
            rest = others;
        }
        by_cluster
    }

    /// The sum of a cluster's residuals relative to its quantile: the paper's consistency index.
    fn excess(&self, residuals: &[f64]) -> f64 {
        residuals.iter().sum::<f64>() / self.quantiles.edges(residuals.len())
    }

    /// Whether the whole passes, and each of its clusters.
    fn passes(&self, fit: &Fit, residuals: &[Vec<f64>]) -> bool {
        self.quantiles.passes(fit) && residuals.iter().all(|residuals| self.excess(residuals) < 1.0)
    }

    /// Tests clusters with many edges before lone edges: a joint optimum of many true and many false edges may fit neither.
    ///
    /// Clusters are tested in groups, a quarter as large as the number accepted since the last rejection. If all clusters
    /// are true, the number of optimisations grows as the logarithm of their number; if few are, it is hardly more than one
    /// a cluster. A group that fails is tried again at half the size, so a cluster is only rejected by itself.
    fn largest_first(&mut self) -> BTreeSet<usize> {
        let mut order: Vec<usize> = (0..self.clusters.len()).collect();
        // A stable sort: among equals, the first in the graph comes first.
        order.sort_by_key(|&cluster| Reverse(self.clusters[cluster].len()));
        let mut waiting = VecDeque::from(order);
        let mut accepted = BTreeSet::new();
        let mut state = self.optimiser.state(&self.edges(&waiting));
        let mut optimum = Fit { chi_square: 0.0, redundancy: 0, residuals: Vec::new() };
        let mut forecasts = BTreeMap::new();
        let (mut streak, mut refusals) = (0, 0);
        while !waiting.is_empty() {
            if refusals == REFUSALS {
                forecasts = self.forecasts(&state, &accepted, &waiting);
                refusals = 0;
            }
            let mut group = Vec::new();
            while group.len() < (streak / 4).max(1)
                && let Some(cluster) = waiting.pop_front()
            {
                if self.hopeless(cluster, &optimum, &forecasts) {
                    self.foreseen += 1;
                } else {
                    group.push(cluster);
                }
            }
            if group.is_empty() {
                break;
            }
            let chosen = accepted.iter().chain(&group).copied().collect();
            self.fits += 1;
            let (fit, next) = self.optimiser.refit(&state, &self.edges(&chosen));
            if self.passes(&fit, &self.by_cluster(&chosen, &fit)) {
                (accepted, optimum, state, streak) = (chosen, fit, next, streak + group.len());
            } else if let [_] = group[..] {
                (streak, refusals) = (0, refusals + 1);
            } else {
                streak = 2 * group.len();
                group.into_iter().rev().for_each(|cluster| waiting.push_front(cluster));
            }
        }
        accepted
    }

    /// The effect of each waiting edge on the optimum over the accepted clusters.
    fn forecasts(
        &self,
        state: &O::State,
        accepted: &BTreeSet<usize>,
        waiting: &VecDeque<usize>,
    ) -> BTreeMap<usize, Forecast> {
        let waiting = self.edges(waiting);
        let forecasts = self.optimiser.forecast(state, &self.edges(accepted), &waiting);
        waiting.into_iter().zip(forecasts).filter_map(|(edge, forecast)| Some((edge, forecast?))).collect()
    }

    /// Whether forecasts rule a cluster out: one of its edges alone would raise chi-square far beyond its quantile or, if
    /// it is the only edge, would keep a residual far beyond its own quantile.
    fn hopeless(&self, cluster: usize, optimum: &Fit, forecasts: &BTreeMap<usize, Forecast>) -> bool {
        let edges = &self.clusters[cluster];
        let slack = self.quantiles.slack(optimum, edges.len());
        edges.iter().filter_map(|edge| forecasts.get(edge)).any(|forecast| {
            forecast.increase > BEYOND * slack
                || edges.len() == 1 && forecast.residual > BEYOND * self.quantiles.edges(1)
        })
    }

    /// Algorithms 2 and 3 of the paper: rounds of [`Self::candidates`] and [`Self::joint`] until nothing new is accepted.
    fn joint_rounds(&mut self) -> BTreeSet<usize> {
        let (mut accepted, mut refused) = (BTreeSet::new(), BTreeSet::new());
        loop {
            let candidates = self.candidates(&accepted, &refused);
            if candidates.is_empty() {
                return accepted;
            }
            let chosen = self.joint(&accepted, &candidates);
            if chosen.len() > accepted.len() {
                // A cluster that was rejected next to a false one may fit now. One that this round rejected does not.
                refused = candidates.difference(&chosen).copied().collect();
                accepted = chosen;
            } else {
                refused.extend(candidates);
            }
        }
    }

    /// The clusters, neither accepted nor rejected so far, that have an edge that passes when all are optimised together.
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

    /// The accepted clusters and the candidates that pass together with them. Until all pass, the candidate that exceeds
    /// its quantile by the largest factor is removed.
    fn joint(&mut self, accepted: &BTreeSet<usize>, candidates: &BTreeSet<usize>) -> BTreeSet<usize> {
        let mut chosen: BTreeSet<usize> = accepted.union(candidates).copied().collect();
        while chosen.len() > accepted.len() {
            let (fit, residuals) = self.fit(&chosen);
            if self.passes(&fit, &residuals) {
                break;
            }
            let worst = chosen
                .iter()
                .zip(&residuals)
                .filter(|(cluster, _)| !accepted.contains(cluster))
                .max_by(|(_, a), (_, b)| self.excess(a).total_cmp(&self.excess(b)));
            let Some((&worst, _)) = worst else { break };
            chosen.remove(&worst);
        }
        chosen
    }
}

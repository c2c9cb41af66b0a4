//! Islands: closures of one cluster that strong ties connect, and the hypotheses that they form.

use std::collections::BTreeMap;

use petgraph::unionfind::UnionFind;

use crate::cut::{Clusters, Tie};
use crate::evidence::{CLIP, Evidence};
use crate::rounds::CONTRADICTED;

/// Evidence along a spanning tree that suffices to join two components, or to contradict odometry, nats.
const STRONG: f64 = 20.0;
/// Members of a cluster that are sampled to decide whether all of it agrees with the map.
const WITNESSES: usize = 16;

/// A cluster of closures between two components that agree on their relative pose.
#[derive(Clone, Debug)]
pub(crate) struct Hypothesis {
    /// Nats along a spanning tree, which counts each stretch of odometry once.
    pub(crate) evidence: f64,
    pub(crate) members: Vec<usize>,
}

impl Hypothesis {
    /// Whether it may join two components, and may contradict odometry. The map decides on weaker ones.
    pub(crate) fn is_strong(&self) -> bool {
        self.evidence > STRONG
    }

    /// A sample of the members, spread evenly.
    pub(crate) fn witnesses(&self) -> Vec<usize> {
        spread(&self.members, WITNESSES)
    }

    /// Whether a condition holds for most members, by a sample.
    pub(crate) fn is_mostly(&self, holds: impl Fn(usize) -> bool) -> bool {
        let witnesses = self.witnesses();
        2 * witnesses.iter().filter(|&&member| holds(member)).count() > witnesses.len()
    }

    /// Whether the evidence contradicts most members.
    pub(crate) fn contradicted(&self, evidence: &[Option<Evidence>]) -> bool {
        self.is_mostly(|member| evidence[member].is_some_and(|found| found.weight() <= CONTRADICTED))
    }
}

/// At most so many of these closures, spread evenly.
pub(crate) fn spread(closures: &[usize], most: usize) -> Vec<usize> {
    let step = closures.len().div_ceil(most).max(1);
    closures.iter().copied().step_by(step).collect()
}

/// For each closure, the sum of its evidence within its cluster.
pub(crate) fn support(clusters: &Clusters, ties: &[Tie], anchored: &[Option<(usize, f64)>]) -> Vec<f64> {
    let count = anchored.len();
    let mut support: Vec<f64> = anchored
        .iter()
        .enumerate()
        .map(|(closure, anchored)| match anchored {
            Some((anchor, ratio)) if clusters.labels[closure] == clusters.labels[count + anchor] => {
                ratio.clamp(-CLIP, CLIP)
            }
            _ => 0.0,
        })
        .collect();
    for tie in ties.iter().filter(|tie| clusters.labels[tie.one] == clusters.labels[tie.other]) {
        support[tie.one] += tie.ratio.clamp(-CLIP, CLIP);
        support[tie.other] += tie.ratio.clamp(-CLIP, CLIP);
    }
    support
}

/// Closures of one cluster that are connected by ties which chance hardly makes: each tie weighs more than `least`. The map
/// of the others judges closures that only weak ties connect to the cluster.
pub(crate) fn islands(
    clusters: &Clusters,
    ties: &[Tie],
    support: &[f64],
    threshold: f64,
    least: f64,
) -> Islands {
    let mut forest = UnionFind::<usize>::new(support.len());
    let mut evidence = vec![0.0; support.len()];
    let mut strong: Vec<&Tie> = ties
        .iter()
        .filter(|tie| tie.ratio > least && clusters.labels[tie.one] == clusters.labels[tie.other])
        .filter(|tie| support[tie.one] > threshold && support[tie.other] > threshold)
        .collect();
    strong.sort_by(|a, b| b.ratio.total_cmp(&a.ratio).then((a.one, a.other).cmp(&(b.one, b.other))));
    for tie in strong {
        let (a, b) = (forest.find(tie.one), forest.find(tie.other));
        if a != b {
            forest.union(a, b);
            evidence[forest.find(a)] = evidence[a] + evidence[b] + tie.ratio.min(CLIP);
        }
    }
    Islands { forest, evidence }
}

/// Sets of closures, each with its evidence along a spanning tree, which counts each stretch of odometry once.
pub(crate) struct Islands {
    pub(crate) forest: UnionFind<usize>,
    evidence: Vec<f64>,
}

impl Islands {
    /// The number of islands with enough support.
    pub(crate) fn count(&self, support: &[f64], threshold: f64) -> usize {
        (0..support.len())
            .filter(|&closure| support[closure] > threshold && self.forest.find(closure) == closure)
            .count()
    }

    /// The largest value of a member, for each root.
    pub(crate) fn best(&self, values: &[Option<f64>]) -> Vec<f64> {
        let mut best = vec![f64::NEG_INFINITY; values.len()];
        for (closure, value) in values.iter().enumerate() {
            let root = self.forest.find(closure);
            best[root] = best[root].max(value.unwrap_or(f64::NEG_INFINITY));
        }
        best
    }

    /// Islands with more evidence than `least`, or strong ones, the heaviest first.
    pub(crate) fn hypotheses(&self, least: f64) -> Vec<Hypothesis> {
        let mut found: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for closure in 0..self.evidence.len() {
            let root = self.forest.find(closure);
            if self.evidence[root] > least.min(STRONG) {
                found.entry(root).or_default().push(closure);
            }
        }
        let mut hypotheses: Vec<Hypothesis> = found
            .into_iter()
            .map(|(root, members)| Hypothesis { evidence: self.evidence[root], members })
            .collect();
        hypotheses.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        hypotheses
    }
}

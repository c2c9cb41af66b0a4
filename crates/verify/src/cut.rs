//! The graph of evidence, and its minimum-cost multicut.

use petgraph::unionfind::UnionFind;
use posecut_multicut::{Graph, Options, solve};

use crate::evidence::CLIP;

/// Work after which the best multicut so far is taken. Unlike a time limit, it gives the same result on every machine.
const WORK: u64 = 30_000_000;
/// Cost of accepting a wrong candidate, in correct candidates lost.
pub(crate) const COST: f64 = 3.0;

/// Evidence that two closures are both correct, nats.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tie {
    pub(crate) one: usize,
    pub(crate) other: usize,
    pub(crate) ratio: f64,
}

/// Clusters of closures, and of the anchors that represent chains.
pub(crate) struct Clusters {
    /// Label of each closure, then of each anchor.
    pub(crate) labels: Vec<u32>,
    /// Bound on the excess of the cost over the minimum, as a share of it; 0 where the cost is proved to be minimal, infinite
    /// without a multicut.
    pub(crate) gap: f64,
}

/// Cuts the graph whose nodes are closures and anchors. `anchored[c]` is the anchor of closure c and the log-likelihood ratio
/// of c against its odometry.
pub(crate) fn cut(
    closures: usize,
    anchors: usize,
    ties: &[Tie],
    anchored: &[Option<(usize, f64)>],
    correct: f64,
) -> Clusters {
    let edges = costs(closures, ties, anchored, correct);
    let options = Options { time_limit: None, work_limit: Some(WORK), ..Options::default() };
    match Graph::new(closures + anchors, edges) {
        Ok(graph) => {
            let solution = solve(&graph, &options);
            // Divide by the larger of the two, because the bound may be zero.
            let cost = solution.objective.abs().max(solution.lower_bound.abs());
            let gap = if solution.optimal { 0.0 } else { solution.gap() / cost };
            Clusters { labels: solution.labels, gap }
        }
        // Costs are clipped and nodes are numbered here, so the only possible error is too many nodes. Then each node is a
        // cluster.
        Err(_) => Clusters { labels: (0..(closures + anchors) as u32).collect(), gap: f64::INFINITY },
    }
}

/// Clusters without a cut: any positive evidence joins two nodes, whatever contradicts it.
pub(crate) fn tied(
    closures: usize,
    anchors: usize,
    ties: &[Tie],
    anchored: &[Option<(usize, f64)>],
    correct: f64,
) -> Clusters {
    let mut clusters = UnionFind::<u32>::new(closures + anchors);
    for (one, other, cost) in costs(closures, ties, anchored, correct) {
        if cost > 0.0 {
            clusters.union(one as u32, other as u32);
        }
    }
    Clusters { labels: clusters.into_labeling(), gap: f64::INFINITY }
}

/// The cost of cutting each pair of nodes.
fn costs(
    closures: usize,
    ties: &[Tie],
    anchored: &[Option<(usize, f64)>],
    correct: f64,
) -> Vec<(u64, u64, f64)> {
    let prior = (COST * (1.0 - correct) / correct).ln();
    let clipped = |ratio: f64| ratio.clamp(-CLIP, CLIP);
    // A pair with too little evidence neither attracts nor repels.
    let pair = |ratio: f64| if ratio > 0.0 { (ratio - COST.ln()).max(0.0) } else { ratio };
    let pairs = ties.iter().map(|tie| (tie.one as u64, tie.other as u64, clipped(pair(tie.ratio))));
    let single = anchored.iter().enumerate().filter_map(|(closure, anchored)| {
        anchored.map(|(anchor, ratio)| ((closures + anchor) as u64, closure as u64, clipped(ratio - prior)))
    });
    pairs.chain(single).collect()
}

//! From evidence to verdicts, in rounds.

use nalgebra::SMatrix;
use petgraph::unionfind::UnionFind;
use posecut_graph::PoseGraph;

use crate::calibration::{Calibration, calibrate};
use crate::cut::{COST, Clusters, Tie, cut};
use crate::evidence::{CLIP, compare};
use crate::map::Drawing;
use crate::model::{Model, Motion};
use crate::partners::Partners;

/// Rounds of cut and map.
const ROUNDS: usize = 10;
/// Log-likelihood ratio at which a closure contradicts the map.
const CONTRADICTED: f64 = -3.0;
/// Evidence below which two parts are not joined, nats.
const LEAST_EVIDENCE: f64 = 20.0;

/// What was found.
pub(crate) struct Judged {
    pub(crate) accepted: Vec<bool>,
    /// Log-likelihood ratio of each closure in the last round, where there was one.
    pub(crate) ratio: Vec<Option<f64>>,
    pub(crate) calibration: Calibration,
    pub(crate) rounds: usize,
    /// Parts of the graph that closures join, and their evidence.
    pub(crate) joined: usize,
}

pub(crate) fn judge<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    model: &Model<G, DOF>,
) -> anyhow::Result<Judged> {
    let debug = std::env::var_os("VERIFY_DEBUG").is_some();
    let partners = Partners::of(model);
    let calibration = calibrate(model, &partners, true);
    let random = calibrate(model, &partners, false);
    if debug {
        eprintln!(
            "alpha {:?} gamma {:?} beta {:.3} pi {:.3} evidence {:.1} prior {}",
            calibration.odometry.iter().take(6).collect::<Vec<_>>(), calibration.coherent.iter().take(6).collect::<Vec<_>>(), calibration.landmark, calibration.correct,
            calibration.evidence, calibration.on_prior
        );
        eprintln!("random alpha {:?} beta {:.3}", random.odometry.iter().take(6).collect::<Vec<_>>(), random.landmark);
    }
    let ties = ties(model, &partners, &calibration);
    let drawing = Drawing::of(graph, model)?;
    let count = model.closures.len();
    let chains = model.chains.chains.len();
    let mut parts = UnionFind::<usize>::new(chains);
    let mut accepted = vec![false; count];
    let mut single: Vec<Option<f64>> = (0..count)
        .map(|closure| {
            let closed = model.single(closure)?;
            Some(compare(&closed.error, &calibration.covariance(&closed), &closed.apart, &calibration.local(&closed.landmark)).map_or(-CLIP, |found| found.distant()))
        })
        .collect();
    let threshold = (COST * count as f64 * (1.0 - calibration.correct)).max(1.0).ln();
    let (mut rounds, mut joined) = (0, 0);
    let mut clusters = Clusters { labels: Vec::new(), optimal: true };
    for round in 0..ROUNDS {
        rounds = round + 1;
        let part = parts.clone().into_labeling();
        let anchored: Vec<Option<(usize, f64)>> = (0..count)
            .map(|closure| single[closure].map(|ratio| (part[model.span(closure).a], ratio)))
            .collect();
        if round == 0 {
            clusters = cut(count, chains, &ties, &anchored, calibration.correct);
        }
        let label = |closure: usize| clusters.labels[closure];
        // Sums of evidence inside each cluster.
        let mut support: Vec<f64> = anchored
            .iter()
            .enumerate()
            .map(|(closure, anchored)| match anchored {
                Some((anchor, ratio)) if label(closure) == clusters.labels[count + anchor] => ratio.clamp(-CLIP, CLIP),
                _ => 0.0,
            })
            .collect();
        let inside = || ties.iter().filter(|tie| label(tie.one) == label(tie.other));
        for tie in inside() {
            support[tie.one] += tie.ratio.clamp(-CLIP, CLIP);
            support[tie.other] += tie.ratio.clamp(-CLIP, CLIP);
        }
        let mut next = vec![false; count];
        for closure in 0..count {
            if let Some((anchor, _)) = anchored[closure] {
                next[closure] = if round == 0 {
                    label(closure) == clusters.labels[count + anchor] && support[closure] > threshold
                } else {
                    single[closure].is_some_and(|ratio| ratio > threshold)
                };
            }
        }
        // Clusters between parts: evidence along a spanning tree, which counts every odometry once.
        let mut order: Vec<&Tie> = inside()
            .filter(|tie| anchored[tie.one].is_none() && support[tie.one] > threshold && support[tie.other] > threshold)
            .collect();
        order.sort_by(|a, b| b.ratio.total_cmp(&a.ratio).then((a.one, a.other).cmp(&(b.one, b.other))));
        let mut forest = UnionFind::<usize>::new(count);
        let mut evidence = vec![0.0; count];
        for tie in order {
            let (a, b) = (forest.find(tie.one), forest.find(tie.other));
            if a != b {
                forest.union(a, b);
                evidence[forest.find(a)] = evidence[a] + evidence[b] + tie.ratio.min(CLIP);
            }
        }
        let mut hypotheses: Vec<usize> =
            (0..count).filter(|&closure| forest.find(closure) == closure && evidence[closure] > LEAST_EVIDENCE).collect();
        hypotheses.sort_by(|a, b| evidence[*b].total_cmp(&evidence[*a]));
        let mut busy = vec![false; chains];
        let mut merged = 0;
        for &hypothesis in &hypotheses {
            let span = model.span(hypothesis);
            let (a, b) = (part[span.a], part[span.b]);
            if busy[a] || busy[b] {
                continue;
            }
            (busy[a], busy[b]) = (true, true);
            parts.union(span.a, span.b);
            merged += 1;
            for closure in 0..count {
                if anchored[closure].is_none() && forest.find(closure) == hypothesis {
                    next[closure] = true;
                }
            }
        }
        joined += merged;
        if debug {
            let truth = |closure: usize| graph.edges[model.closures[closure].candidate.edge].truth_correct();
            let kept = (0..count).filter(|&c| next[c]).count();
            let wrong = (0..count).filter(|&c| next[c] && truth(c) == Some(false)).count();
            let lost = (0..count).filter(|&c| !next[c] && truth(c) == Some(true)).count();
            eprintln!("round {round}: kept {kept} F{wrong} L{lost} merged {merged} optimal {} T {threshold:.1} best {:?}",
                clusters.optimal, hypotheses.iter().take(3).map(|&h| evidence[h]).collect::<Vec<_>>());
        }
        if std::env::var_os("VERIFY_TIES").is_some() && round == 0 {
            for tie in &ties {
                let e = |c: usize| { let e = &graph.edges[model.closures[c].candidate.edge]; (e.id, e.truth_correct()) };
                eprintln!("tie {:?} {:?} {:.2} cut {}", e(tie.one), e(tie.other), tie.ratio, label(tie.one) != label(tie.other));
            }
        }
        if std::env::var_os("VERIFY_EDGES").is_some() {
            for c in 0..count {
                let e = &graph.edges[model.closures[c].candidate.edge];
                let t = e.truth_correct();
                let inside = anchored[c].map(|(a, _)| label(c) == clusters.labels[count + a]);
                if (t == Some(true)) != next[c] {
                    eprintln!("  edge {} {}->{} correct {t:?} single {:?} support {:.1} anchored {inside:?}", e.id, e.from, e.to, single[c], support[c]);
                }
            }
        }
        if next == accepted && merged == 0 {
            break;
        }
        accepted = next;
        let part = parts.clone().into_labeling();
        let asked: Vec<usize> = (0..count)
            .filter(|&closure| part[model.span(closure).a] == part[model.span(closure).b])
            .collect();
        let mut map = drawing.map(&random, &accepted)?;
        let judged = map.judge(&drawing, model, &random, &accepted, &asked);
        // Of the accepted ones that the rest contradicts, the worst third goes first: the others may be its victims.
        let mut worst: Vec<f64> = asked
            .iter()
            .zip(&judged)
            .filter(|(closure, _)| accepted[**closure])
            .filter_map(|(_, evidence)| evidence.filter(|evidence| evidence.weight() <= CONTRADICTED))
            .map(|evidence| evidence.squared_distance)
            .collect();
        worst.sort_by(|a, b| b.total_cmp(a));
        let limit = worst.get(worst.len().div_ceil(3).saturating_sub(1)).copied().unwrap_or(f64::INFINITY);
        for (&closure, evidence) in asked.iter().zip(judged) {
            if accepted[closure]
                && evidence.is_some_and(|found| found.weight() <= CONTRADICTED && found.squared_distance < limit)
            {
                continue;
            }
            // Where the rest of the map does not hold both ends, what was known before counts.
            single[closure] = evidence.map(|evidence| evidence.weight()).or(single[closure]).or(Some(0.0));
        }
    }
    Ok(Judged { accepted, ratio: single, calibration, rounds, joined })
}

fn ties<G: Motion<DOF>, const DOF: usize>(
    model: &Model<G, DOF>,
    partners: &Partners,
    calibration: &Calibration,
) -> Vec<Tie> {
    let mut pairs: Vec<(usize, usize)> = (0..model.closures.len())
        .flat_map(|one| {
            let others = partners.near(one).iter().chain(partners.far(one));
            others.map(move |&other| (one.min(other), one.max(other)))
        })
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
        .into_iter()
        .filter_map(|(one, other)| {
            let closed = model.pair(one, other);
            let sigma: SMatrix<f64, DOF, DOF> = calibration.covariance(&closed);
            let evidence = compare(&closed.error, &sigma, &closed.apart, &calibration.local(&closed.landmark))?;
            Some(Tie { one, other, ratio: evidence.weight() })
        })
        .collect()
}

//! From evidence to decisions, in rounds.

use std::collections::BTreeMap;

use nalgebra::SMatrix;
use petgraph::unionfind::UnionFind;
use posecut_graph::PoseGraph;
use rayon::prelude::*;

use crate::calibration::{Calibration, calibrate};
use crate::cut::{COST, Clusters, Tie, cut};
use crate::evidence::{CLIP, compare};
use crate::map::Drawing;
use crate::model::{Model, Motion};
use crate::partners::Partners;

/// Most rounds of map and verdicts that do not mainly add closures.
const ROUNDS: usize = 12;
/// Most rounds in all, and the growth of a round that mainly adds.
const ROUNDS_IN_ALL: usize = 60;
const GROWTH: f64 = 1.02;
/// Evidence along a spanning tree below which a cluster does not join two parts, nats.
pub(crate) const LEAST_EVIDENCE: f64 = 20.0;
/// Log-likelihood ratio at which a closure contradicts the map.
pub(crate) const CONTRADICTED: f64 = -3.0;
/// Largest probability of being wrong at which a closure is accepted.
const DOUBT_MOST: f64 = 0.05;
/// Members of a cluster that are looked at to tell whether all of it agrees with the map.
const WITNESSES: usize = 16;

/// What was found.
pub(crate) struct Judged {
    pub(crate) accepted: Vec<bool>,
    /// Log-likelihood ratio of each closure in the last round, where there is one.
    pub(crate) ratio: Vec<Option<f64>>,
    pub(crate) calibration: Calibration,
    pub(crate) rounds: usize,
    pub(crate) hypotheses: Vec<Hypothesis>,
    pub(crate) cut_proved: bool,
    /// Evidence of the pairs compared.
    pub(crate) ties: Vec<Tie>,
    /// Parts of the graph that closures could join, and those that they do.
    pub(crate) joinable: usize,
    pub(crate) joined: usize,
}

/// A cluster of closures between two parts that agree on how these lie.
#[derive(Clone, Debug)]
pub(crate) struct Hypothesis {
    /// Nats along a spanning tree, which counts every odometry once.
    pub(crate) evidence: f64,
    pub(crate) members: Vec<usize>,
}

/// Everything that rounds need.
struct Rounds<'a, G, const DOF: usize> {
    model: &'a Model<G, DOF>,
    partners: Partners,
    drawing: Drawing<G, DOF>,
    /// Calibration without coherent terms, which the optimiser does not have.
    random: Calibration,
    threshold: f64,
    /// The same for islands, which are fewer.
    loose: f64,
    hypotheses: Vec<Hypothesis>,
    /// Parts of the graph: chains that accepted closures join.
    parts: UnionFind<usize>,
    accepted: Vec<bool>,
    ratio: Vec<Option<f64>>,
    /// Whether the error is as small as that of 95 % of correct closures.
    fits: Vec<bool>,
    /// Whether a closure without any error would have too little evidence, since the map says too little about its ends.
    unseen: Vec<bool>,
    /// Squared distance that 95 % of correct closures stay below.
    usual: f64,
    /// Where the last map ended, if the next is nearly the same.
    poses: Option<Vec<G>>,
}

pub(crate) fn judge<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    model: &Model<G, DOF>,
) -> anyhow::Result<Judged> {
    let partners = Partners::of(model);
    let calibration = calibrate(model, &partners, true);
    let random = calibrate(model, &partners, false);
    let ties = ties(model, &partners, &calibration);
    let count = model.closures.len();
    let ratio: Vec<Option<f64>> = (0..count)
        .map(|closure| {
            let closed = model.single(closure)?;
            let local = calibration.local(&closed.landmark);
            let evidence = compare(&closed.error, &calibration.covariance(&closed), &closed.apart, &local);
            evidence.map(|found| found.distant())
        })
        .collect();
    let threshold = (COST * count as f64 * (1.0 - calibration.correct)).max(1.0).ln();
    let chains = model.chains.chains.len();
    let anchored: Vec<Option<(usize, f64)>> = ratio
        .iter()
        .enumerate()
        .map(|(closure, ratio)| ratio.map(|ratio| (model.span(closure).a, ratio)))
        .collect();
    let clusters = cut(count, chains, &ties, &anchored, calibration.correct);
    let support = support(&clusters, &ties, &anchored);
    // Islands that hang together closely are as many chances to agree by chance, and no more.
    let close = islands(&clusters, &ties, &support, threshold, threshold);
    let trials = close.count(&support, threshold) as f64;
    let loose = (COST * trials * (1.0 - calibration.correct)).max(1.0).ln();
    let islands = islands(&clusters, &ties, &support, threshold, loose);
    let best = islands.best(&ratio);
    // What an island says of the trajectory shares its odometry: it counts once, as its best member does.
    let accepted: Vec<bool> = (0..count)
        .map(|closure| {
            anchored[closure]
                .is_some_and(|(anchor, _)| clusters.labels[closure] == clusters.labels[count + anchor])
                && support[closure] > threshold
                && best[islands.forest.find(closure)] > loose
        })
        .collect();
    let hypotheses = islands.hypotheses();
    let parts = UnionFind::new(chains);
    let drawing = Drawing::of(graph, model)?;
    let mut rounds = Rounds {
        model,
        partners,
        drawing,
        random,
        threshold,
        loose,
        hypotheses,
        parts,
        accepted,
        ratio,
        fits: vec![false; count],
        unseen: vec![false; count],
        usual: usual(DOF),
        poses: None,
    };
    let (mut number, mut settling) = (0, 0);
    let mut next = rounds.accepted.clone();
    rounds.join(&mut next);
    while settling < ROUNDS && number < ROUNDS_IN_ALL {
        rounds.accepted = next;
        number += 1;
        next = rounds.round()?;
        if next == rounds.accepted {
            break;
        }
        let size = |set: &[bool]| set.iter().filter(|member| **member).count() as f64;
        settling += usize::from(size(&next) < GROWTH * size(&rounds.accepted));
    }
    let mut all = UnionFind::<usize>::new(chains);
    let joinable = model.spans.iter().filter(|span| all.union(span.a, span.b)).count();
    let mut held = UnionFind::<usize>::new(chains);
    let spans = (0..count).filter(|&closure| rounds.accepted[closure]).map(|closure| model.span(closure));
    let joined = spans.filter(|span| held.union(span.a, span.b)).count();
    let Rounds { accepted, ratio, hypotheses, .. } = rounds;
    let cut_proved = clusters.optimal;
    Ok(Judged {
        accepted,
        ratio,
        calibration,
        rounds: number,
        hypotheses,
        cut_proved,
        ties,
        joinable,
        joined,
    })
}

impl<G: Motion<DOF>, const DOF: usize> Rounds<'_, G, DOF> {
    /// Draws the map of what is accepted, judges every closure within its parts by it, and joins further parts. Returns what
    /// is accepted next.
    fn round(&mut self) -> anyhow::Result<Vec<bool>> {
        let part = self.parts.clone().into_labeling();
        let within = |closure: usize| {
            let span = self.model.span(closure);
            part[span.a] == part[span.b]
        };
        let asked: Vec<usize> = (0..self.accepted.len()).filter(|&closure| within(closure)).collect();
        let open = |hypothesis: &&Hypothesis| {
            let accepted = hypothesis.members.iter().filter(|&&member| self.accepted[member]).count();
            within(hypothesis.members[0]) && 2 * accepted < hypothesis.members.len()
        };
        let first: Vec<usize> = self.hypotheses.iter().filter(open).flat_map(Hypothesis::witnesses).collect();
        let mut map = self.drawing.map(self.model, &self.random, &self.accepted, self.poses.as_deref())?;
        map.enough = self.threshold;
        let judged = map.judge(&self.partners, &asked, &first);
        let poses = map.poses;
        // Of the accepted ones that the rest contradicts the worst third goes first: the others may be its victims.
        let mut worst: Vec<f64> = asked
            .iter()
            .zip(&judged)
            .filter(|(closure, _)| self.accepted[**closure])
            .filter_map(|(_, evidence)| evidence.filter(|evidence| evidence.weight() <= CONTRADICTED))
            .map(|evidence| evidence.squared_distance)
            .collect();
        worst.sort_by(|a, b| b.total_cmp(a));
        let limit = worst.get(worst.len().div_ceil(3).saturating_sub(1)).copied().unwrap_or(f64::INFINITY);
        for (&closure, evidence) in asked.iter().zip(judged) {
            let spared = self.accepted[closure]
                && evidence
                    .is_some_and(|found| found.weight() <= CONTRADICTED && found.squared_distance < limit);
            // Where the rest of the map does not hold both ends, what was known before counts.
            match evidence {
                Some(evidence) if !spared => {
                    self.ratio[closure] = Some(evidence.weight());
                    self.unseen[closure] = evidence.most <= self.loose;
                    self.fits[closure] = evidence.squared_distance <= self.usual;
                }
                _ => {}
            }
        }
        let mut next: Vec<bool> = (0..self.accepted.len())
            .map(|closure| within(closure) && self.ratio[closure].is_some_and(|ratio| ratio > self.threshold))
            .collect();
        for closure in self.likely(&next) {
            next[closure] = within(closure);
        }
        for closure in asked {
            // Accepted with a hypothesis, and the map does not hold both ends without it.
            next[closure] |= self.accepted[closure] && self.ratio[closure].is_none();
        }
        let agreeing: Vec<usize> = self
            .hypotheses
            .iter()
            .filter(open)
            .filter(|hypothesis| {
                let witnesses = hypothesis.witnesses();
                let agree = witnesses
                    .iter()
                    .filter(|&&member| self.ratio[member].is_some_and(|ratio| ratio > self.loose))
                    .count();
                2 * agree > witnesses.len()
            })
            .flat_map(|hypothesis| hypothesis.members.iter().copied())
            .collect();
        for member in agreeing {
            next[member] = true;
        }
        // Where odometry says nothing of closures, only an island's own evidence can place it: the heaviest goes first.
        if self.random.on_prior
            && let Some(unseen) =
                self.hypotheses.iter().filter(open).find(|hypothesis| self.unplaced(hypothesis))
        {
            for &member in &unseen.members {
                next[member] = true;
            }
        }
        let joined = self.join(&mut next);
        // Nearly the same map: start from this one.
        self.poses = (!joined).then_some(poses);
        Ok(next)
    }

    /// Whether the map could hardly support most members of a hypothesis if they were correct, and does not contradict them.
    fn unplaced(&self, hypothesis: &Hypothesis) -> bool {
        let witnesses = hypothesis.witnesses();
        let unseen = witnesses.iter().filter(|&&member| {
            self.unseen[member] && self.ratio[member].is_some_and(|ratio| ratio > CONTRADICTED)
        });
        2 * unseen.count() > witnesses.len()
    }

    /// Closures with less evidence than a random one might have somewhere, but which are likely where they are: they fit as
    /// correct ones do, the posterior probability is high, and among all of them less than a third of a wrong one is expected.
    fn likely(&self, next: &[bool]) -> Vec<usize> {
        let odds = self.random.correct / (1.0 - self.random.correct);
        let mut doubts: Vec<(f64, usize)> = (0..next.len())
            .filter(|&closure| !next[closure] && self.fits[closure])
            .filter_map(|closure| Some((1.0 / (1.0 + odds * self.ratio[closure]?.exp()), closure)))
            .filter(|(doubt, _)| *doubt < DOUBT_MOST)
            .collect();
        doubts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut expected = 0.0;
        doubts
            .into_iter()
            .take_while(|(doubt, _)| {
                expected += doubt;
                expected < 1.0 / COST
            })
            .map(|(_, closure)| closure)
            .collect()
    }

    /// Joins parts by the hypotheses of most evidence, each part at most once a round, so that the next round judges the
    /// others by the larger map.
    fn join(&mut self, next: &mut [bool]) -> bool {
        let part = self.parts.clone().into_labeling();
        let mut busy = vec![false; part.len()];
        for hypothesis in &self.hypotheses {
            let span = self.model.span(hypothesis.members[0]);
            let (a, b) = (part[span.a], part[span.b]);
            if a == b || busy[a] || busy[b] {
                continue;
            }
            (busy[a], busy[b]) = (true, true);
            self.parts.union(span.a, span.b);
            for &member in &hypothesis.members {
                next[member] = true;
            }
        }
        busy.contains(&true)
    }
}

impl Hypothesis {
    /// Members spread over the whole.
    fn witnesses(&self) -> Vec<usize> {
        let step = self.members.len().div_ceil(WITNESSES).max(1);
        self.members.iter().copied().step_by(step).collect()
    }
}

/// Sum of the evidence that each closure has within its cluster.
fn support(clusters: &Clusters, ties: &[Tie], anchored: &[Option<(usize, f64)>]) -> Vec<f64> {
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

/// Closures of one cluster that hang together by ties which chance hardly makes: each weighs more than the least evidence
/// of a member. What only weak ties join to a cluster is judged by the map that the rest makes.
fn islands(clusters: &Clusters, ties: &[Tie], support: &[f64], threshold: f64, least: f64) -> Islands {
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

/// Sets of closures, each with its evidence along a spanning tree, which counts every odometry once.
struct Islands {
    forest: UnionFind<usize>,
    evidence: Vec<f64>,
}

impl Islands {
    /// How many there are among members.
    fn count(&self, support: &[f64], threshold: f64) -> usize {
        (0..support.len())
            .filter(|&closure| support[closure] > threshold && self.forest.find(closure) == closure)
            .count()
    }

    /// The largest value of a member, for each root.
    fn best(&self, values: &[Option<f64>]) -> Vec<f64> {
        let mut best = vec![f64::NEG_INFINITY; values.len()];
        for (closure, value) in values.iter().enumerate() {
            let root = self.forest.find(closure);
            best[root] = best[root].max(value.unwrap_or(f64::NEG_INFINITY));
        }
        best
    }

    /// Islands of enough evidence, the heaviest first.
    fn hypotheses(&self) -> Vec<Hypothesis> {
        let mut found: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for closure in 0..self.evidence.len() {
            let root = self.forest.find(closure);
            if self.evidence[root] > LEAST_EVIDENCE {
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

/// The evidence of each pair of partners.
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
        .into_par_iter()
        .filter_map(|(one, other)| {
            let closed = model.pair(one, other);
            let sigma: SMatrix<f64, DOF, DOF> = calibration.covariance(&closed);
            let evidence =
                compare(&closed.error, &sigma, &closed.apart, &calibration.local(&closed.landmark))?;
            Some(Tie { one, other, ratio: evidence.weight() })
        })
        .collect()
}

/// The 95 % quantile of chi-square (Wilson and Hilferty 1931).
fn usual(degrees: usize) -> f64 {
    let degrees = degrees as f64;
    let spread = 2.0 / (9.0 * degrees);
    degrees * (1.0 - spread + 1.645 * spread.sqrt()).powi(3)
}

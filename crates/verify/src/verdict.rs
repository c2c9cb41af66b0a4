//! The verdict on every landmark edge, and the reason for it.

use posecut_graph::PoseGraph;
use serde_json::Value;

use crate::calibration::alone;
use crate::cut::Tie;
use crate::evidence::CLIP;
use crate::judge::Judged;
use crate::model::{Model, Motion};
use crate::rounds::{CONTRADICTED, is_vague};

/// Most edges that are named as witnesses.
const WITNESSES: usize = 3;
/// Odds that an undecided candidate is correct, over those of the mixture. Pairs that share odometry count it several times, so
/// the mixture is too sure of candidates that little supports. Chosen on the tuning half (docs/trust.md, calibration).
const UNDECIDED_ODDS: f64 = 1.0 / 7.0;

/// The decision on an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is part of the map.
    Accepted,
    /// It contradicts the map or the odometry.
    Rejected,
    /// Nothing supports it enough, and nothing contradicts it.
    Undecided,
}

/// The reason for a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Other closures and the odometry predict what it measures.
    Supported,
    /// Its measurement is far from what the map predicts.
    Contradicted,
    /// It agrees with the map, but so would a random edge in its place.
    Chance,
    /// It agrees with the map, which is too uncertain there to show whether the measurement is somewhat wrong.
    Vague,
    /// No other closure is near enough to support or contradict it.
    Alone,
    /// It belongs to a group of closures that agree with each other, but not with the map, or not with another group where the map cannot
    /// tell which is correct.
    OtherHypothesis,
}

/// A verdict with its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Index of the edge in the graph.
    pub edge: usize,
    /// The verdict.
    pub verdict: Verdict,
    /// The reason.
    pub reason: Reason,
    /// Probability that the edge is correct.
    pub probability: f64,
    /// Log-likelihood ratio of correct against chance, where there is one; nats.
    pub ratio: Option<f64>,
    /// Edges that support an accepted edge most, or contradict another edge most.
    pub witnesses: Vec<u64>,
    /// 0 for the map; for members of another hypothesis, its number.
    pub hypothesis: Option<usize>,
}

/// A finding for every closure, in the order of the closures.
pub(crate) fn findings<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    model: &Model<G, DOF>,
    judged: &Judged,
) -> Vec<Finding> {
    let count = model.closures.len();
    let mut rival = vec![None; count];
    for (number, hypothesis) in (1..).zip(judged.others()) {
        for &member in &hypothesis.members {
            rival[member] = Some(number);
        }
    }
    let witnesses = witnesses(&judged.ties, &judged.accepted);
    let opposed = opposed(&judged.ties, count);
    let alone = judged.factors.loops.odds() * alone(&judged.ratio, &judged.accepted);
    (0..count)
        .map(|closure| {
            let accepted = judged.accepted[closure];
            let ratio = judged.ratio[closure];
            let (verdict, reason) = match ratio {
                _ if accepted => (Verdict::Accepted, Reason::Supported),
                Some(ratio) if ratio <= CONTRADICTED && rival[closure].is_some() => {
                    (Verdict::Rejected, Reason::OtherHypothesis)
                }
                Some(ratio) if ratio <= CONTRADICTED => (Verdict::Rejected, Reason::Contradicted),
                _ if rival[closure].is_some() => (Verdict::Undecided, Reason::OtherHypothesis),
                Some(_) if is_vague(judged.local[closure]) => (Verdict::Undecided, Reason::Vague),
                Some(_) => (Verdict::Undecided, Reason::Chance),
                None => (Verdict::Undecided, Reason::Alone),
            };
            let id = |other: &usize| graph.edges[model.closures[*other].candidate.edge].id;
            Finding {
                edge: model.closures[closure].candidate.edge,
                verdict,
                reason,
                probability: probability(closure, verdict, judged, alone / (1.0 + opposed[closure])),
                ratio,
                witnesses: witnesses[closure].iter().map(id).collect(),
                hypothesis: if accepted { Some(0) } else { rival[closure] },
            }
        })
        .collect()
}

/// The posterior probability of a mixture. The prior odds are those of candidates about which the map is equally informative,
/// or `alone` where there is no evidence. The odds of undecided candidates are calibrated. Closures of a group that nothing else speaks
/// for are as credible as the group: it is correct or wrong as a whole.
fn probability(closure: usize, verdict: Verdict, judged: &Judged, alone: f64) -> f64 {
    let group = judged.credibility[closure];
    if let Some(credibility) = group.filter(|_| verdict == Verdict::Undecided) {
        return credibility;
    }
    let odds = match judged.ratio[closure] {
        Some(ratio) => ratio.clamp(-CLIP, CLIP).exp() * judged.odds[closure],
        // It was accepted with a hypothesis, and nothing else supports it.
        None if judged.accepted[closure] => CLIP.exp() * judged.factors.loops.odds(),
        None => alone,
    };
    let against = 1.0 / odds + judged.local[closure];
    let calibrated = if verdict == Verdict::Undecided { against / UNDECIDED_ODDS } else { against };
    group.unwrap_or(1.0) / (1.0 + calibrated)
}

/// For each candidate, how many others contradict it. At most one of two that contradict each other can be correct.
fn opposed(ties: &[Tie], count: usize) -> Vec<f64> {
    let mut opposed = vec![0.0; count];
    for tie in ties.iter().filter(|tie| tie.ratio <= CONTRADICTED) {
        opposed[tie.one] += 1.0;
        opposed[tie.other] += 1.0;
    }
    opposed
}

/// The accepted partners that support each accepted closure most, or contradict each other closure most.
fn witnesses(ties: &[Tie], accepted: &[bool]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<(f64, usize)>> = vec![Vec::new(); accepted.len()];
    for tie in ties {
        for (one, other) in [(tie.one, tie.other), (tie.other, tie.one)] {
            let weight = if accepted[one] { tie.ratio } else { -tie.ratio };
            if accepted[other] && weight > 0.0 {
                all[one].push((weight, other));
            }
        }
    }
    all.into_iter()
        .map(|mut of| {
            of.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            of.into_iter().take(WITNESSES).map(|(_, other)| other).collect()
        })
        .collect()
}

impl Finding {
    /// Writes the finding to the fields of its edge. Rejects the edge in the name of the stage if the verdict is rejected, or
    /// if it is undecided and such edges are not kept. Returns whether it rejected the edge.
    pub fn mark(&self, graph: &mut PoseGraph, stage: &str, keep_undecided: bool) -> bool {
        let rejected = match self.verdict {
            Verdict::Accepted => false,
            Verdict::Rejected => true,
            Verdict::Undecided => !keep_undecided,
        };
        let edge = &mut graph.edges[self.edge];
        if rejected {
            edge.reject(stage);
        }
        let fields = [
            ("verify_verdict", self.verdict.name().into()),
            ("verify_reason", self.reason.name().into()),
            ("verify_probability", rounded(self.probability).into()),
            ("verify_witness", self.witnesses.clone().into()),
            ("verify_hypothesis", self.hypothesis.map_or(Value::Null, Value::from)),
        ];
        for (field, value) in fields {
            edge.extra.insert(field.to_owned(), value);
        }
        rejected
    }

    /// The explanation of the verdict, one line a fact.
    pub fn story(&self, graph: &PoseGraph) -> Vec<String> {
        let edge = &graph.edges[self.edge];
        let ratio = self.ratio.map_or_else(
            || "neither other edges nor the odometry predict what it measures".to_owned(),
            |ratio| {
                format!("log-likelihood ratio of correct against chance or a local error: {ratio:.1} nats")
            },
        );
        let named: Vec<String> = self.witnesses.iter().map(u64::to_string).collect();
        let side = if self.verdict == Verdict::Accepted { "for" } else { "against" };
        let witnesses = if named.is_empty() {
            format!("no accepted edge is evidence {side} it")
        } else {
            format!("accepted edges with the most evidence {side} it: {}", named.join(", "))
        };
        vec![
            format!("edge {} from node {} to node {}: {}", edge.id, edge.from, edge.to, self.verdict.name()),
            format!("reason: {}", self.reason.sentence()),
            ratio,
            witnesses,
            format!("probability that it is correct: {:.3}", self.probability),
        ]
    }
}

impl Verdict {
    /// The value of the field `verify_verdict`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Rejected => "rejected",
            Self::Undecided => "undecided",
        }
    }
}

impl Reason {
    /// The value of the field `verify_reason`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Supported => "supported",
            Self::Contradicted => "contradicted",
            Self::Chance => "chance",
            Self::Vague => "vague",
            Self::Alone => "alone",
            Self::OtherHypothesis => "other-hypothesis",
        }
    }

    fn sentence(self) -> &'static str {
        match self {
            Self::Supported => "supported: other edges and the odometry predict what it measures",
            Self::Contradicted => "contradicted: its measurement is far from what the map predicts",
            Self::Chance => {
                "chance: it agrees with the map no better than a random edge would; a second landmark edge within a few metres of it would decide"
            }
            Self::Vague => {
                "vague: the map is too uncertain there to show whether its measurement is somewhat wrong; a second landmark edge within a few metres of it would decide"
            }
            Self::Alone => {
                "alone: no other edge is near enough to support or contradict it; a second landmark edge within a few metres of it would decide"
            }
            Self::OtherHypothesis => {
                "other-hypothesis: it belongs to a group of edges that agree with each other, but not with the map, or not with another group where the map cannot tell which is correct"
            }
        }
    }
}

/// Rounds to six decimals: further digits would only differ between processors.
fn rounded(probability: f64) -> f64 {
    (probability * 1e6).round() / 1e6
}

//! The whole method: takes a graph, returns findings.

use std::borrow::Cow;

use anyhow::{Context as _, ensure};
use posecut_graph::{EdgeKind, PoseGraph};

use crate::calibration::Calibration;
use crate::factors::Factors;
use crate::ingredients::Ingredient;
use crate::judge::{Judged, Known, judge};
use crate::model::{Model, Motion};
use crate::partners::Partners;
use crate::renumber::renumbered;
use crate::rivals::{Rival, rivals};
use crate::verdict::{Finding, Verdict, findings};

/// Most searches for broken odometry: behind one break there may be another.
const PASSES: usize = 8;

/// How many times the evidence of the whole chains' loops those of their pieces must have for factors of their own. Where correct edges span a
/// broken step, most loops contradicted each other before, and the factors explained a minority. Elsewhere, pieces have fewer loops than the
/// whole, and factors of their own are worse.
const CLEARER: f64 = 2.0;

/// What verification found.
#[derive(Clone, Debug, PartialEq)]
pub struct Verification {
    /// One finding for each landmark edge in use that has a measurement.
    pub findings: Vec<Finding>,
    /// Landmark edges in use without a measurement; these are not judged.
    pub unmeasured: usize,
    /// Landmark edges that an earlier stage rejected; these are not judged.
    pub rejected_before: usize,
    /// How many connections between chains, or between components that others connect, the landmark edges propose.
    pub joins_proposed: usize,
    /// How many of these connections the accepted edges make.
    pub joins_established: usize,
    /// Groups of edges that agree with each other, accepted or not.
    pub hypotheses: usize,
    /// Hypotheses between two chains whose evidence is comparable to that of the accepted edges there.
    pub rivals: Vec<Rival>,
    /// Factors on covariances, for each chain, or for each piece of a chain with broken odometry.
    pub calibration: Calibration,
    /// Indices of broken odometry edges in the graph.
    pub broken: Vec<usize>,
    /// Bound on the excess of the multicut's cost over the minimum, as a share of it; 0 where it is proved to be minimal.
    pub cut_gap: f64,
    /// Rounds of map and verdicts.
    pub rounds: usize,
    /// A sentence about odometry edges that fit into no chain, if there are any.
    pub warning: Option<String>,
}

impl Verification {
    /// The number of findings with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.findings.iter().filter(|finding| finding.verdict == verdict).count()
    }

    /// The explanation of the verdict on the landmark edge with this id (`--explain`), one line a fact.
    ///
    /// # Errors
    ///
    /// The edge was not judged.
    pub fn story(&self, graph: &PoseGraph, id: u64) -> anyhow::Result<Vec<String>> {
        let finding = self.findings.iter().find(|finding| graph.edges[finding.edge].id == id).with_context(|| {
            match graph.edges.iter().find(|edge| edge.id == id) {
                None => format!(
                    "--explain {id}: the graph has no edge with this id; give the id of a landmark edge"
                ),
                Some(edge) if edge.kind == EdgeKind::Odometry => {
                    format!("--explain {id}: this is an odometry edge; give the id of a landmark edge")
                }
                Some(_) => format!(
                    "--explain {id}: this edge was not judged, because an earlier stage rejected it or it has no measurement; give the id of an edge in use"
                ),
            }
        })?;
        Ok(finding.story(graph))
    }
}

/// Judges every landmark edge in use, without the ground truth.
pub fn verify<G: Motion<DOF>, const DOF: usize>(graph: &PoseGraph) -> anyhow::Result<Verification> {
    verify_by::<G, DOF>(graph, 0, &[])
}

/// Like [`verify`], with another hypothesis instead of the edges that join its two chains, and without some ingredients of
/// the method. `hypothesis` is the number that [`verify`] gives it; 0 is the map.
///
/// # Errors
///
/// The graph has no such hypothesis, or the hypothesis lies within one chain, whose odometry contradicts it.
pub fn verify_by<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    hypothesis: usize,
    without: &[Ingredient],
) -> anyhow::Result<Verification> {
    G::verify(graph, hypothesis, without)
}

/// The body of [`verify_by`].
pub(crate) fn run<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    hypothesis: usize,
    without: &[Ingredient],
) -> anyhow::Result<Verification> {
    let Parts { graph, model, mut judged, broken } =
        Parts::<G, DOF>::of(renumbered::<G, DOF>(graph), without)?;
    if hypothesis > 0 {
        let chosen = judged.others().nth(hypothesis - 1).with_context(|| match judged.others().count() {
            0 => format!(
                "--hypothesis {hypothesis}: this graph has no hypothesis except the map; leave --hypothesis out"
            ),
            count => format!(
                "--hypothesis {hypothesis}: this graph has hypotheses 0 (the map) to {count} only; give one of these numbers"
            ),
        })?;
        let members = chosen.members.clone();
        ensure!(
            !model.same_chain(members[0]),
            "--hypothesis {hypothesis}: its edges lie within one chain, whose odometry contradicts them; choose a hypothesis that joins two chains"
        );
        judged = judge(
            &graph,
            &model,
            Some(&members),
            Some(Known { factors: judged.factors, accepted: Vec::new() }),
        )?;
    }
    let findings = findings(&graph, &model, &judged);
    Ok(Verification {
        findings,
        unmeasured: model.unmeasured,
        rejected_before: model.rejected_before,
        joins_proposed: judged.joinable,
        joins_established: judged.joined,
        hypotheses: judged.hypotheses.iter().filter(|hypothesis| hypothesis.is_strong()).count(),
        rivals: rivals(&model, &judged),
        calibration: judged.factors.loops,
        broken,
        cut_gap: judged.cut_gap,
        rounds: judged.rounds,
        warning: model.chains.warning(),
    })
}

/// A graph whose chains are split where their odometry is broken, and the results on it.
struct Parts<'a, G, const DOF: usize> {
    graph: Cow<'a, PoseGraph>,
    model: Model<G, DOF>,
    judged: Judged,
    broken: Vec<usize>,
}

impl<'a, G: Motion<DOF>, const DOF: usize> Parts<'a, G, DOF> {
    /// Judges a graph, and repeats without the odometry that turns out to be broken.
    fn of(mut graph: Cow<'a, PoseGraph>, without: &[Ingredient]) -> anyhow::Result<Self> {
        let mut model = Model::<G, DOF>::of(&graph, without)?;
        let mut judged = judge(&graph, &model, None, None)?;
        let mut broken = Vec::new();
        for _ in 0..PASSES {
            if judged.breaks.is_empty() {
                break;
            }
            for &step in &judged.breaks {
                graph.to_mut().edges[step].reject("verify");
            }
            broken.append(&mut judged.breaks);
            let mut accepted: Vec<usize> = (0..judged.accepted.len())
                .filter(|&closure| judged.accepted[closure])
                .map(|closure| model.closures[closure].candidate.edge)
                .collect();
            accepted.sort_unstable();
            let parts = Model::<G, DOF>::of(&graph, without)?;
            let mut whole = vec![0; parts.chains.chains.len()];
            for (&(part, _), &(chain, _)) in parts.chains.places.iter().zip(&model.chains.places) {
                whole[part] = chain;
            }
            model = parts;
            let factors = calibrated_again(&model, judged.factors.of_parts(&whole));
            judged = judge(&graph, &model, None, Some(Known { factors, accepted }))?;
        }
        broken.sort_unstable();
        Ok(Self { graph, model, judged, broken })
    }
}

/// The factors of these chains, or the given ones, which the chains had before they were split, unless their own explain much more.
fn calibrated_again<G: Motion<DOF>, const DOF: usize>(model: &Model<G, DOF>, before: Factors) -> Factors {
    let own = Factors::of(model, &Partners::of(model));
    if own.loops.evidence > CLEARER * before.loops.evidence.max(0.0) { own } else { before }
}

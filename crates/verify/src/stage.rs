//! Verification as a stage.

use std::collections::BTreeMap;

use posecut_graph::{PoseGraph, for_dimension};
use posecut_stage::{Context, Doubt, Examples, GraphStage, Phase, Place, counted, info, warn};
use serde::Serialize;

use crate::ingredients::Ingredient;
use crate::model::Motion;
use crate::verdict::Verdict;
use crate::verification::{Verification, verify_by};

/// What becomes of edges that nothing decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Undecided {
    /// Keep them in use
    Keep,
    /// Mark them as rejected
    Reject,
}

/// The options of verification.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// Keep or reject landmark edges that nothing supports and nothing contradicts
    #[arg(long, value_enum, default_value_t = Undecided::Reject)]
    pub undecided: Undecided,

    /// Apply the hypothesis with this number in `verify_hypothesis` instead of the one with the most evidence; 0 is the map
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub hypothesis: usize,

    /// Leave out an ingredient of the method, to measure its effect; may be given several times
    #[arg(long, value_enum, value_name = "INGREDIENT")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub without: Vec<Ingredient>,

    /// Explain the verdict on the landmark edge with this id, in five lines on standard error
    #[arg(long, value_name = "EDGE")]
    #[serde(skip)]
    pub explain: Option<u64>,
}

impl GraphStage for Options {
    const NAME: &'static str = "verify";
    const ABOUT: &'static str =
        "Judge every landmark edge by evidence: accepted, rejected or undecided, with a reason";
    const PLACE: Place = Place(Phase::Judgement, 0);
    const DOUBTS: &'static [Doubt] =
        &[Doubt::SearchLimit, Doubt::NothingKept, Doubt::CalibrationOnPrior, Doubt::PartsNotConnected];
    const EXAMPLES: Examples = Examples(&[
        (
            "Find the wrong edges of a g2o file, and optimise the poses",
            "posecut convert graph.g2o | posecut verify | posecut optimize -o map.jsonl",
        ),
        (
            "Explain the verdict on landmark edge 17",
            "posecut verify graph.jsonl --explain 17 -o verified.jsonl",
        ),
        (
            "Write a table of all verdicts",
            "posecut verify graph.jsonl | posecut inspect edges --csv -o edges.csv",
        ),
    ]);

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        self.judge(graph, context).map(drop)
    }
}

impl Options {
    /// Does what the stage does, and returns the findings too.
    pub fn judge(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<Verification> {
        for_dimension!(graph.header.dimension, |G, DOF| self.verify::<G, DOF>(graph, context))
    }

    fn verify<G: Motion<DOF>, const DOF: usize>(
        &self,
        graph: &mut PoseGraph,
        context: &mut Context,
    ) -> anyhow::Result<Verification> {
        let verification = verify_by::<G, DOF>(graph, self.hypothesis, &self.without)?;
        self.explain(graph, &verification)?;
        let mut rejected = 0;
        for finding in &verification.findings {
            rejected += usize::from(finding.mark(graph, Self::NAME, self.undecided == Undecided::Keep));
        }
        report(&verification);
        doubt(&verification, context);
        note(&verification, graph, rejected, context);
        Ok(verification)
    }

    fn explain(&self, graph: &PoseGraph, verification: &Verification) -> anyhow::Result<()> {
        let Some(id) = self.explain else { return Ok(()) };
        for line in verification.story(graph, id)? {
            info!("{line}");
        }
        Ok(())
    }
}

fn report(verification: &Verification) {
    if let Some(warning) = &verification.warning {
        warn!("{warning}");
    }
    let Verification { findings, rivals, broken, .. } = verification;
    info!(
        "{} judged: {} accepted, {} rejected, {} undecided",
        counted(findings.len(), "landmark edge"),
        verification.count(Verdict::Accepted),
        verification.count(Verdict::Rejected),
        verification.count(Verdict::Undecided)
    );
    for rival in rivals {
        let number = rival.hypothesis;
        let named =
            format!("hypothesis {number} ({}, {:.0} nats)", counted(rival.edges, "edge"), rival.evidence);
        if rival.lone {
            warn!(
                "undecided hypothesis: {named} alone joins its chains, on a short stretch, and the map contradicts more groups like it than it accepts; --hypothesis {number} applies it"
            );
        } else if rival.is_open() {
            warn!(
                "undecided hypotheses: {named} joins chains that nothing else joins, and another one of comparable evidence joins them differently; --hypothesis {number} applies it"
            );
        } else {
            warn!(
                "two hypotheses: {named} joins the same chains differently from the accepted edges ({:.0} nats); --hypothesis {number} applies it",
                rival.accepted
            );
        }
    }
    if !broken.is_empty() {
        warn!(
            "the odometry is broken at {}: landmark edges that agree with each other and with the usual motion contradict it; --stats lists the ids of these odometry edges under broken_odometry",
            counted(broken.len(), "step")
        );
    }
}

/// The gap of the multicut above which hypotheses are in doubt. Below it, rounds of map and verdicts compensate.
const LARGE_GAP: f64 = 0.01;

/// Raises the doubts about the verdicts. Without candidates there is nothing to doubt.
fn doubt(verification: &Verification, context: &mut Context) {
    let Verification { findings, joins_proposed, joins_established, calibration, cut_gap, .. } = verification;
    if findings.is_empty() {
        return;
    }
    if cut_gap.is_finite() && *cut_gap > LARGE_GAP {
        context.doubt(
            Doubt::SearchLimit,
            format!(
                "the search for the multicut reached its limit, and its cost may be {:.1} % above the minimum: other hypotheses may \
                 have more evidence; examine edges with --explain",
                100.0 * cut_gap
            ),
        );
    }
    let open = joins_proposed.saturating_sub(*joins_established);
    let overlap = format!(
        "no overlap is established for {open} of {} that landmark edges propose",
        counted(*joins_proposed, "join")
    );
    if verification.count(Verdict::Accepted) == 0 {
        let none = format!("0 of {} accepted", counted(findings.len(), "landmark edge"));
        let remedy = "check the units of the information and whether there is overlap, or examine edges with --explain";
        if open > 0 {
            context.doubt(Doubt::NothingKept, format!("{none}, and {overlap}; {remedy}"));
            context.also_doubt(Doubt::PartsNotConnected);
        } else {
            context.doubt(Doubt::NothingKept, format!("{none}; {remedy}"));
        }
    } else if open > 0 {
        context.doubt(
            Doubt::PartsNotConnected,
            format!(
                "{overlap}: these components of the graph remain separate; add landmark edges between them, or examine edges with --explain"
            ),
        );
    }
    if calibration.on_prior {
        context.doubt(
            Doubt::CalibrationOnPrior,
            format!(
                "the covariances are used unchanged: the landmark edges give too little evidence to calibrate them ({:.1} nats more \
                 than shuffled ones); check the covariances, or add landmark edges that close loops",
                calibration.evidence
            ),
        );
    }
}

fn note(verification: &Verification, graph: &PoseGraph, rejected: usize, context: &mut Context) {
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    for finding in &verification.findings {
        *reasons.entry(finding.reason.name()).or_default() += 1;
    }
    let broken: Vec<u64> = verification.broken.iter().map(|&edge| graph.edges[edge].id).collect();
    let statistics = &mut context.statistics;
    statistics.note("candidates", verification.findings.len());
    statistics.note("unmeasured", verification.unmeasured);
    statistics.note("rejected_before", verification.rejected_before);
    statistics.note("accepted", verification.count(Verdict::Accepted));
    statistics.note("contradicted", verification.count(Verdict::Rejected));
    statistics.note("undecided", verification.count(Verdict::Undecided));
    statistics.note("rejected", rejected);
    statistics.note("reasons", reasons);
    statistics.note("joins_proposed", verification.joins_proposed);
    statistics.note("joins_established", verification.joins_established);
    statistics.note("hypotheses", verification.hypotheses);
    statistics.note("rivals", &verification.rivals);
    statistics.note("calibration", &verification.calibration);
    statistics.note("broken_odometry", broken);
    statistics.note("cut_proved", verification.cut_gap == 0.0);
    statistics.note("cut_gap", verification.cut_gap.is_finite().then_some(verification.cut_gap));
    statistics.note("rounds", verification.rounds);
}

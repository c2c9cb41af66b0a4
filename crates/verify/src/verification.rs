//! The whole of it: a graph in, findings out.

use anyhow::{Context as _, ensure};
use posecut_graph::PoseGraph;

use crate::calibration::Calibration;
use crate::ingredients::Ingredient;
use crate::judge::judge;
use crate::model::{Model, Motion};
use crate::renumber::renumbered;
use crate::rivals::{Rival, rivals};
use crate::verdict::{Finding, Verdict, findings};

/// What verification found.
#[derive(Clone, Debug, PartialEq)]
pub struct Verification {
    /// One for each landmark edge in use that has a measurement.
    pub findings: Vec<Finding>,
    /// Landmark edges in use without a measurement: not judged.
    pub unmeasured: usize,
    /// Landmark edges that an earlier stage rejected: not judged.
    pub rejected_before: usize,
    /// How many joins of chains (or of parts that others join) landmark edges propose.
    pub joins_proposed: usize,
    /// How many of them accepted edges make.
    pub joins_established: usize,
    /// Groups of edges that agree with each other, accepted or not.
    pub hypotheses: usize,
    /// Hypotheses between two chains that have comparable evidence to what is accepted between them.
    pub rivals: Vec<Rival>,
    /// Factors on covariances.
    pub calibration: Calibration,
    /// Whether the multicut is proved optimal.
    pub cut_proved: bool,
    /// Rounds of map and verdicts.
    pub rounds: usize,
}

impl Verification {
    /// Findings of one verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.findings.iter().filter(|finding| finding.verdict == verdict).count()
    }
}

/// Judges every landmark edge in use. The truth is not looked at.
pub fn verify<G: Motion<DOF>, const DOF: usize>(graph: &PoseGraph) -> anyhow::Result<Verification> {
    verify_by::<G, DOF>(graph, 0, &[])
}

/// The same, with another hypothesis in the place of what joins its two chains, by the number that [`verify`] gives it; 0 is the
/// map; and without some ingredients of the method, to see what they are worth.
///
/// # Errors
///
/// The graph has no such hypothesis, or it lies within one chain, whose odometry leaves no choice.
pub fn verify_by<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    hypothesis: usize,
    without: &[Ingredient],
) -> anyhow::Result<Verification> {
    let graph = &*renumbered::<G, DOF>(graph);
    let model = Model::<G, DOF>::of(graph, without)?;
    let mut judged = judge(graph, &model, None)?;
    if hypothesis > 0 {
        let chosen = judged.others().nth(hypothesis - 1).with_context(|| {
            let count = judged.others().count();
            format!(
                "hypothesis {hypothesis}: this graph has {count} beside the map; name one of 0 to {count}"
            )
        })?;
        let members = chosen.members.clone();
        ensure!(
            !model.same_chain(members[0]),
            "hypothesis {hypothesis}: its edges lie within one chain, whose odometry contradicts them; another hypothesis can only replace a join of two chains"
        );
        judged = judge(graph, &model, Some(&members))?;
    }
    let findings = findings(graph, &model, &judged);
    Ok(Verification {
        findings,
        unmeasured: model.unmeasured,
        rejected_before: model.rejected_before,
        joins_proposed: judged.joinable,
        joins_established: judged.joined,
        hypotheses: judged.hypotheses.len(),
        rivals: rivals(&model, &judged),
        calibration: judged.calibration,
        cut_proved: judged.cut_proved,
        rounds: judged.rounds,
    })
}

//! The whole of it: a graph in, findings out.

use posecut_graph::PoseGraph;

use crate::calibration::Calibration;
use crate::judge::judge;
use crate::model::{Model, Motion};
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
    let model = Model::<G, DOF>::of(graph)?;
    let judged = judge(graph, &model)?;
    let findings = findings(graph, &model, &judged);
    Ok(Verification {
        findings,
        unmeasured: model.unmeasured,
        rejected_before: model.rejected_before,
        joins_proposed: judged.joinable,
        joins_established: judged.joined,
        hypotheses: judged.hypotheses.len(),
        calibration: judged.calibration,
        cut_proved: judged.cut_proved,
        rounds: judged.rounds,
    })
}

//! Verification as a stage.

use posecut_geometry::{SE2, SE3};
use posecut_graph::{Dimension, PoseGraph};
use posecut_stage::{Context, GraphStage, info};
use serde::Serialize;

use crate::judge::judge;
use crate::model::{Model, Motion};

/// The options of verification.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {}

impl GraphStage for Options {
    const NAME: &'static str = "verify";
    const ABOUT: &'static str = "Judge every landmark edge by evidence: keep, reject or leave undecided";

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        match graph.header.dimension {
            Dimension::Two => self.verify::<SE2, 3>(graph, context),
            Dimension::Three => self.verify::<SE3, 6>(graph, context),
        }
    }
}

impl Options {
    fn verify<G: Motion<DOF>, const DOF: usize>(
        &self,
        graph: &mut PoseGraph,
        context: &mut Context,
    ) -> anyhow::Result<()> {
        let model = Model::<G, DOF>::of(graph)?;
        let judged = judge(graph, &model)?;
        let mut kept = 0;
        for (closure, accepted) in model.closures.iter().zip(&judged.accepted) {
            if *accepted {
                kept += 1;
            } else {
                graph.edges[closure.candidate.edge].reject(Self::NAME);
            }
        }
        info!("{kept} of {} landmark edges kept", model.closures.len());
        context.statistics.note("kept", kept);
        context.statistics.note("rounds", judged.rounds);
        Ok(())
    }
}

//! Re-admission as a stage.

use anyhow::bail;
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_pcm::Scale;
use posecut_pcm::calibration::Scales;
use posecut_pcm::chance::COST;
use posecut_stage::{Context, Doubt, Examples, GraphStage, Phase, Place, counted, info, warn};
use serde::Serialize;

use crate::{Readmission, Readmitted, readmit};

/// The options of re-admission.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// Re-admit a rejected edge whose innovation is within the chi-square quantile of this probability
    #[arg(long, value_name = "P", default_value_t = 0.99)]
    pub admit: f64,

    /// Drop an edge in use whose innovation is beyond the chi-square quantile of this probability
    #[arg(long, value_name = "P", default_value_t = 0.9999)]
    pub drop: f64,

    /// Multiply all covariances by FACTOR; `auto` estimates it from the edges in use
    #[arg(long, value_name = "FACTOR", default_value_t = Scale::Fixed(Scales::ONE), value_parser = one_factor)]
    pub scale: Scale,

    /// Rescale the information matrices of landmark edges in the output by the covariance scale
    #[arg(long)]
    pub apply_scale: bool,

    /// Do not re-admit edges that agree by chance alone, where a wrong edge costs as much as COST correct ones
    #[arg(long, value_name = "COST", default_value_t = COST)]
    pub chance: f64,
}

/// A marginal covariance cannot be split into the shares of odometry and landmark edges, which PCM scales separately.
fn one_factor(text: &str) -> Result<Scale, &'static str> {
    match text.parse() {
        Ok(Scale::Fixed(Scales { odometry, landmark })) if odometry != landmark => {
            Err("re-admission takes one scale; expected `auto` or a positive number")
        }
        Ok(scale) => Ok(scale),
        Err(_) => Err("expected `auto` or a positive number"),
    }
}

impl Options {
    fn readmission(&self) -> Readmission {
        let scale = match self.scale {
            Scale::Fixed(Scales { landmark, .. }) => Some(landmark),
            Scale::Auto => None,
        };
        Readmission {
            admit: self.admit,
            drop: self.drop,
            scale,
            apply_scale: self.apply_scale,
            cost: self.chance,
        }
    }
}

impl GraphStage for Options {
    const NAME: &'static str = "readmit";
    const ABOUT: &'static str = "Judge every landmark edge by the optimiser's marginals: re-admit rejected edges that agree with the map, drop edges in use that do not";
    const PLACE: Place = Place(Phase::Judgement, 15);
    const DOUBTS: &'static [Doubt] = &[Doubt::NothingKept];
    const EXAMPLES: Examples = Examples(&[
        (
            "Take back correct edges that PCM rejected",
            "posecut pcm graph.jsonl | posecut optimize --marginals landmark |\n    posecut readmit | posecut optimize -o map.jsonl",
        ),
        (
            "Estimate the covariance scale from the edges in use",
            "posecut readmit marginals.jsonl --scale auto -o readmitted.jsonl",
        ),
    ]);

    fn check(&self) -> anyhow::Result<()> {
        if !(self.chance > 0.0 && self.chance.is_finite()) {
            bail!("--chance is {}, but must be a positive number", self.chance);
        }
        Ok(())
    }

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        let result = readmit(graph, &self.readmission())?;
        note(&result, graph, context);
        Ok(())
    }
}

/// Reports the results of re-admission.
fn note(result: &Readmitted, graph: &PoseGraph, context: &mut Context) {
    info!(
        "{} re-admitted and {} dropped of {}",
        result.readmitted,
        result.dropped,
        counted(result.tested, "landmark edge")
    );
    let in_use = |edge: &&posecut_graph::Edge| edge.in_use() && edge.measurement.is_some();
    if result.tested > 0 && graph.edges_of(EdgeKind::Landmark).filter(in_use).count() == 0 {
        context.doubt(
            Doubt::NothingKept,
            format!(
                "0 of {} in use after re-admission; check the units of the information, the covariances (--scale) and whether \
                 there is overlap",
                counted(result.tested, "landmark edge")
            ),
        );
    }
    if let Some(estimate) = result.unbounded_scale {
        warn!(
            "the landmark edges in use suggest a covariance scale of {estimate:.1}, but {} is used, because false edges in use raise the estimate",
            result.scale
        );
    }
    let statistics = &mut context.statistics;
    statistics.note("agree_by_chance", result.by_chance);
    statistics.note("tested", result.tested);
    statistics.note("readmitted", result.readmitted);
    statistics.note("dropped", result.dropped);
    statistics.note("changed", result.readmitted + result.dropped);
    statistics.note("untestable", result.untestable);
    statistics.note("unmeasured", result.unmeasured);
    statistics.note("rejected_by_others", result.rejected_by_others);
    statistics.note("scale", result.scale);
}

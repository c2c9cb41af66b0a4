//! The stages that run on a graph in memory.

use clap::Command;
use posecut_graph::{InputDigest, PoseGraph};
use posecut_stage::{CommonArguments, Context, Examples, GraphStage, Identity, Phase, Place, Target};
use pyo3::prelude::*;

use crate::error::{Error, parse};
use crate::messages::{Messages, collected};

/// A stage, with the type of its options erased.
#[derive(Clone, Copy)]
pub(crate) struct Stage {
    name: &'static str,
    options: fn(Command) -> Command,
    run: fn(PoseGraph, &[String], InputDigest) -> anyhow::Result<Finished>,
}

/// All stages, in the order of lists.
static STAGES: [Stage; 11] = [
    Stage::of::<posecut_verify::Options>(),
    Stage::of::<posecut_pcm::stage::StageOptions>(),
    Stage::of::<posecut_multicut::stage::StageOptions>(),
    Stage::of::<posecut_optimize::stage::StageOptions>(),
    Stage::of::<posecut_readmit::Options>(),
    Stage::of::<posecut_label::stage::Options>(),
    Stage::of::<posecut_oracle::Options>(),
    Stage::of::<posecut_ransac::Options>(),
    Stage::of::<posecut_islands::Options>(),
    Stage::of::<posecut_densest::Options>(),
    Stage::of::<posecut_voting::Options>(),
];

/// The result of a stage.
pub(crate) struct Finished {
    pub(crate) graph: PoseGraph,
    /// The statistics, as JSON.
    pub(crate) statistics: String,
    /// The names of the doubts.
    pub(crate) doubts: Vec<&'static str>,
    pub(crate) messages: Messages,
}

impl Stage {
    const fn of<S: GraphStage>() -> Self {
        Self { name: S::NAME, options: |command| S::augment_args(command), run: run::<S> }
    }

    /// The stage of that name.
    pub(crate) fn named(name: &str) -> PyResult<Self> {
        STAGES.into_iter().find(|stage| stage.name == name).ok_or_else(|| {
            Error::new_err(format!("there is no stage {name:?}; use one of {}", names().join(", ")))
        })
    }

    /// Runs the stage as its program would with these options, on a graph that it would read from a file with this digest.
    pub(crate) fn run(
        self,
        graph: PoseGraph,
        words: &[String],
        input: InputDigest,
    ) -> anyhow::Result<Finished> {
        (self.run)(graph, words, input)
    }
}

fn run<S: GraphStage>(
    mut graph: PoseGraph,
    words: &[String],
    input: InputDigest,
) -> anyhow::Result<Finished> {
    let stage: S = parse(S::NAME, words)?;
    stage.check()?;
    if let Some((option, _)) = stage.further_outputs().first() {
        anyhow::bail!(
            "{option} names a file to write beside the graph, which only the program does; run posecut-{} {option} FILE",
            S::NAME
        );
    }
    let mut context = context(S::NAME, S::ABOUT, S::PLACE);
    context.inputs.push(input);
    let (done, messages) = collected(|| stage.run(&mut graph, &mut context));
    done?;
    context.record_provenance(&mut graph, &stage, stage.seed())?;
    Ok(Finished {
        graph,
        statistics: serde_json::to_string(context.statistics.as_map())?,
        doubts: context.doubts(),
        messages,
    })
}

/// The context of a program that prints nothing.
pub(crate) fn context(name: &'static str, about: &'static str, place: Place) -> Context {
    let common = CommonArguments {
        output: Target::Standard,
        stats: None,
        threads: 0,
        strict: false,
        quiet: true,
        verbose: false,
    };
    let version = env!("CARGO_PKG_VERSION");
    Context::new(Identity { name, version, about, place, examples: Examples::default() }, common)
}

/// The context of the conversion of files.
pub(crate) fn conversion() -> Context {
    context("convert", "", Place(Phase::Graphs, 40))
}

/// The names of the stages.
#[pyfunction]
pub(crate) fn names() -> Vec<&'static str> {
    STAGES.iter().map(|stage| stage.name).collect()
}

/// The options of a stage, as its program's help shows them.
#[pyfunction]
pub(crate) fn help(name: &str) -> PyResult<String> {
    let stage = Stage::named(name)?;
    let command = Command::new(stage.name).disable_help_flag(true).help_template("{options}").term_width(100);
    Ok((stage.options)(command).render_help().to_string())
}

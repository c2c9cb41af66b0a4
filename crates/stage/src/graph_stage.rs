//! Stages from graph to graph.

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use posecut_graph::PoseGraph;
use serde::Serialize;

use crate::{
    CommonArguments, Context, Doubt, Examples, Identity, Outcome, Phase, Place, Source, run_with_doubts,
};

/// A stage that reads one pose graph, adds its findings and writes the graph again.
///
/// The options are the fields of the implementing type. Clap reads them, and their JSON goes into the provenance. The JSON
/// must therefore hold everything that shapes the result and nothing else (`serde(skip)` leaves files out).
pub trait GraphStage: clap::Args + Serialize {
    /// The stage's name without `posecut-`.
    const NAME: &'static str;

    /// One sentence that says what the stage does.
    const ABOUT: &'static str;

    /// The position in lists of programs. The default is after the stages of this workspace that judge landmark edges.
    const PLACE: Place = Place(Phase::Judgement, 100);

    /// The doubts that the stage may raise about its result, for help and documentation.
    const DOUBTS: &'static [Doubt] = &[];

    /// Examples for the long help and the manual page.
    const EXAMPLES: Examples = Examples(&[]);

    /// The seed, for a stage that draws random numbers.
    fn seed(&self) -> Option<u64> {
        None
    }

    /// Refuses meaningless options before anything is read.
    fn check(&self) -> anyhow::Result<()> {
        Ok(())
    }

    /// Files that the stage writes beside the graph, each with the option that names it. They are checked before anything is
    /// read and written with the graph. [`Self::run`] hands over their content ([`Context::further_output`]).
    fn further_outputs(&self) -> Vec<(&'static str, &Path)> {
        Vec::new()
    }

    /// Does the work on a graph that has been read and validated.
    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()>;
}

#[derive(Parser)]
struct GraphCommand<S: GraphStage> {
    /// The pose graph to read (JSON Lines, may be compressed); `-` is standard input
    #[arg(value_name = "INPUT", default_value = "-")]
    input: Source,

    #[command(flatten)]
    stage: S,

    /// Leave rejected edges out of the output instead of marking them
    #[arg(long, help_heading = "Output")]
    drop_rejected: bool,

    #[command(flatten)]
    common: CommonArguments,
}

/// The options of a stage, as its command line would read them from these words: for programs that run the stage inside.
///
/// # Errors
///
/// The stage's command line would refuse the words.
pub fn options<S: GraphStage>(words: &[String]) -> Result<S, clap::Error> {
    let command = S::augment_args(clap::Command::new(S::NAME).no_binary_name(true));
    S::from_arg_matches(&command.try_get_matches_from(words)?)
}

/// The `main` of a stage from graph to graph.
pub fn run_graph_stage<S: GraphStage>(version: &'static str) -> ExitCode {
    let identity =
        Identity { name: S::NAME, version, about: S::ABOUT, place: S::PLACE, examples: S::EXAMPLES };
    run_with_doubts::<GraphCommand<S>>(
        identity,
        S::DOUBTS,
        |command| &command.common,
        |command, context| {
            command.stage.check()?;
            for (option, path) in command.stage.further_outputs() {
                context.check_further_output(option, path)?;
            }
            let mut graph = context.read_graph(&command.input, "graph")?;
            command.stage.run(&mut graph, context)?;
            context.record_provenance(&mut graph, &command.stage, command.stage.seed())?;
            if command.drop_rejected {
                graph.drop_rejected();
            }
            for (option, path) in command.stage.further_outputs() {
                context.write_further_output(option, path)?;
            }
            context.write_graph(&graph)?;
            Ok(Outcome::Done)
        },
    )
}

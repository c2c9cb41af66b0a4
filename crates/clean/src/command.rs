//! The command line.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use posecut_convert::input::ReadingOptions;
use posecut_stage::{
    CommonArguments, Context, Doubt, Examples, Identity, Outcome, Phase, Place, Source, run_with_doubts,
};
use posecut_verify::Undecided;
use serde::Serialize;

use crate::run::clean;

/// The arguments of the program.
#[derive(Parser)]
pub struct Command {
    /// The graph to read, in any format that posecut-convert reads; `-` is standard input. Several files become one graph
    #[arg(value_name = "INPUT", default_value = "-")]
    pub(crate) inputs: Vec<Source>,

    #[command(flatten)]
    pub(crate) judgement: Judgement,

    /// Explain the verdict on the landmark edge with this id, in five lines
    #[arg(long, value_name = "EDGE")]
    pub(crate) explain: Option<u64>,

    /// Leave rejected edges out of JSON Lines too, instead of marking them; other formats cannot mark edges
    #[arg(long, help_heading = "Output")]
    pub(crate) drop_rejected: bool,

    /// Write a table of all landmark edges (verdict, probability, reason, witnesses, residual) to this CSV file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) edges: Option<PathBuf>,

    /// Write a page to this HTML file: the map before and after, why each edge is kept or rejected, and what is doubtful in the input
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) page: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) reading: ReadingOptions,

    #[command(flatten)]
    common: CommonArguments,
}

/// The options that decide the result.
#[derive(clap::Args, Serialize)]
pub(crate) struct Judgement {
    /// Find wrong edges by `verify`, by other stages joined by + and each with its options (pcm+multicut, "pcm --chance 3"), or
    /// by `none`
    #[arg(long, value_name = "NAME", default_value = "verify")]
    pub(crate) method: String,

    /// Keep or reject landmark edges that nothing supports and nothing contradicts
    #[arg(long, value_enum, default_value_t = Undecided::Reject)]
    pub(crate) undecided: Undecided,

    /// Apply the hypothesis with this number instead of the one with the most evidence; 0 is the map
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) hypothesis: usize,
}

impl Command {
    /// The files beside the result, each with its option.
    pub(crate) fn further_outputs(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        [("--edges", &self.edges), ("--page", &self.page)]
            .into_iter()
            .filter_map(|(option, path)| Some((option, path.as_deref()?)))
    }
}

/// The doubts that reading, verification or `--method pcm+multicut`, and optimisation may raise.
const DOUBTS: &[Doubt] = &[
    Doubt::NotConverged,
    Doubt::Undetermined,
    Doubt::SearchLimit,
    Doubt::NothingKept,
    Doubt::EverythingCut,
    Doubt::NoSupportWithinDelta,
    Doubt::CalibrationOnPrior,
    Doubt::CovarianceInvented,
    Doubt::PartsNotConnected,
];

const EXAMPLES: Examples = Examples(&[
    (
        "Write a graph without its wrong edges, and a page that shows why",
        "posecut clean graph.g2o -o cleaned.g2o --page graph.html",
    ),
    ("Explain the verdict on landmark edge 17", "posecut clean graph.g2o --explain 17 -o cleaned.g2o"),
    (
        "Find wrong edges by the paper's method",
        "posecut clean graph.g2o --method pcm+multicut -o cleaned.g2o",
    ),
]);

/// The program's `main`.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "clean",
        version: env!("CARGO_PKG_VERSION"),
        about: "Find the wrong landmark edges of a graph in any format, optimise the others, and write the graph back",
        place: Place(Phase::Start, 0),
        examples: EXAMPLES,
    };
    run_with_doubts::<Command>(
        identity,
        DOUBTS,
        |command| &command.common,
        |command, context: &mut Context| {
            clean(command, context)?;
            Ok(Outcome::DoneUnlessDoubtful)
        },
    )
}

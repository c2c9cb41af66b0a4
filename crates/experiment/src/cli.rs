//! The command line of `posecut-experiment`.

use std::process::ExitCode;

use posecut_stage::{Examples, Identity, Phase, Place, run};

use crate::command;

const EXAMPLES: Examples = Examples(&[
    (
        "Run an experiment on NCLT sessions, and resume it after an interruption",
        "posecut experiment run pipelines/paper.toml --nclt data/nclt",
    ),
    (
        "Collect its results",
        "posecut experiment collect pipelines/paper.toml --nclt data/nclt \\\n    -o results.jsonl",
    ),
    (
        "Use another program for a stage",
        "posecut experiment run pipelines/paper.toml --program pcm=./my-stage",
    ),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "experiment",
        version: env!("CARGO_PKG_VERSION"),
        about: "Plan and run declared experiments, and compare their results with expectations",
        place: Place(Phase::Runs, 10),
        examples: EXAMPLES,
    };
    run::<command::Command>(identity, |command| &command.common, command::execute)
}

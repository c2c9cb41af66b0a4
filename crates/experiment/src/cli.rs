//! The command line of `posecut-experiment`.

use std::process::ExitCode;

use posecut_stage::{Identity, Phase, Place, run};

use crate::command;

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "experiment",
        version: env!("CARGO_PKG_VERSION"),
        about: "Plan and run declared experiments, and compare their results with expectations",
        place: Place(Phase::Runs, 10),
    };
    run::<command::Command>(identity, |command| &command.common, command::execute)
}

//! `posecut-experiment`: plans and runs declared experiments, and checks their results against expectations.

mod command;

use std::process::ExitCode;

use posecut_stage::{Identity, Phase, Place, run};

fn main() -> ExitCode {
    let identity = Identity {
        name: "experiment",
        version: env!("CARGO_PKG_VERSION"),
        about: "Plan and run declared experiments, and compare their results with expectations",
        place: Place(Phase::Runs, 10),
    };
    run::<command::Command>(identity, |command| &command.common, command::execute)
}

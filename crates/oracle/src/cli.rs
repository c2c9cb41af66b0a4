//! The command line of `posecut-oracle`.

use std::process::ExitCode;

use posecut_stage::run_graph_stage;

/// The `main` of the program.
pub fn main() -> ExitCode {
    run_graph_stage::<crate::Options>(env!("CARGO_PKG_VERSION"))
}

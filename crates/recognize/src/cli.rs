//! The command line of `posecut-recognize`.

use std::process::ExitCode;

use posecut_stage::run_graph_stage;

/// The `main` of the program.
pub fn main() -> ExitCode {
    run_graph_stage::<crate::stage::Options>(env!("CARGO_PKG_VERSION"))
}

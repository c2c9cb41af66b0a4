//! The command line of `posecut-optimize`.

use std::process::ExitCode;

/// The `main` of the program.
pub fn main() -> ExitCode {
    crate::command::main()
}

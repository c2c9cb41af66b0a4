//! The command line of `posecut-isam`.

use std::process::ExitCode;

/// The `main` of the program.
pub fn main() -> ExitCode {
    crate::stage::main()
}

//! The arguments of the running program, which need not be those of the process: `posecut pcm INPUT` runs posecut-pcm with INPUT.

use std::ffi::OsString;
use std::sync::OnceLock;

static ARGUMENTS: OnceLock<Vec<OsString>> = OnceLock::new();

/// The arguments of the program, its name first.
pub fn arguments() -> impl Iterator<Item = OsString> {
    ARGUMENTS.get().cloned().unwrap_or_else(|| std::env::args_os().collect()).into_iter()
}

/// Sets the arguments of a program that is built into this one. Only the first call has an effect.
pub fn set_arguments(arguments: Vec<OsString>) {
    let _ = ARGUMENTS.set(arguments);
}

//! `posecut`: runs the programs of posecut by their names.

use posecut::{entry, registry::Registry};

fn main() -> std::process::ExitCode {
    entry::run(&Registry::of_this_machine(), std::env::args_os().skip(1))
}

//! `posecut`: runs the programs of posecut by their names.

use posecut::{built_in, entry};
use posecut_stage::registry::{Registry, set_built_in};

fn main() -> std::process::ExitCode {
    set_built_in(built_in::names());
    entry::run(&Registry::of_this_machine(), std::env::args_os().skip(1))
}

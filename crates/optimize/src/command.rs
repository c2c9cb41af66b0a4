//! The program: a stage from graph to graph, with clearer errors than the parser's for two kinds of arguments.

use std::io::Write as _;
use std::process::ExitCode;

use clap::ValueEnum as _;
use posecut_stage::{GraphStage as _, arguments, run_graph_stage};

use crate::stage::{Graduation, StageOptions};

/// Options of the incremental solver, which was a mode of this program before.
const OF_ISAM: [&str; 9] = [
    "--relinearise-translation",
    "--relinearise-rotation",
    "--relinearise-every",
    "--propagate",
    "--linearisation-error",
    "--solutions",
    "--unfinished",
    "--every",
    "--estimates",
];

/// The program's `main`.
pub fn main() -> ExitCode {
    let words: Vec<String> = arguments()
        .skip(1)
        .map(|word| word.to_string_lossy().into_owned())
        .take_while(|word| word != "--")
        .collect();
    if let Some(sentence) = separate_cost(&words).or_else(|| moved_option(&words)) {
        let _ = writeln!(std::io::stderr(), "posecut-{}: error: {sentence}", StageOptions::NAME);
        return ExitCode::from(2);
    }
    run_graph_stage::<StageOptions>(env!("CARGO_PKG_VERSION"))
}

/// The error for a cost that follows `--gnc` as a separate argument: the parser would take the cost for the input file, and
/// report the file as one argument too many.
fn separate_cost(words: &[String]) -> Option<String> {
    let pair =
        words.windows(2).find(|pair| pair[0] == "--gnc" && Graduation::from_str(&pair[1], false).is_ok())?;
    let cost = &pair[1];
    Some(format!(
        "--gnc takes its cost after an equals sign: write --gnc={cost}, or ./{cost} for an input file of this name"
    ))
}

/// The error for an option that moved to posecut-isam.
fn moved_option(words: &[String]) -> Option<String> {
    let options = words.iter().map(|word| word.split_once('=').map_or(word.as_str(), |(option, _)| option));
    let option = options.into_iter().find(|option| *option == "--solver" || OF_ISAM.contains(option))?;
    Some(if option == "--solver" {
        "--solver is no longer an option: posecut-optimize is the batch solver, and posecut-isam the incremental one; run \
         posecut-isam instead of --solver isam2, or leave --solver out"
            .to_owned()
    } else {
        format!("{option} is an option of the incremental solver; run posecut-isam, or leave {option} out")
    })
}

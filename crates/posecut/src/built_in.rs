//! The programs that are built into `posecut`, so that one file is all of posecut.
//!
//! A program beside `posecut` comes first, so a stage that was just built is the one that runs, and a stage that is not listed here
//! is found all the same.

use std::process::ExitCode;

/// The `main` of a program.
type Main = fn() -> ExitCode;

/// Each program by its name without `posecut-`.
const PROGRAMS: [(&str, Main); 29] = [
    ("clean", posecut_clean::command::main),
    ("conform", posecut_conform::cli::main),
    ("construct", posecut_construct::cli::main),
    ("convert", posecut_convert::cli::main),
    ("densest", posecut_densest::cli::main),
    ("doctor", posecut_doctor::cli::main),
    ("evaluate", posecut_evaluate::cli::main),
    ("experiment", posecut_experiment::cli::main),
    ("ingest", posecut_ingest::cli::main),
    ("inspect", posecut_inspect::cli::main),
    ("isam", posecut_isam::cli::main),
    ("islands", posecut_islands::cli::main),
    ("label", posecut_label::cli::main),
    ("map", posecut_map::cli::main),
    ("multicut", posecut_multicut::cli::main),
    ("optimize", posecut_optimize::cli::main),
    ("oracle", posecut_oracle::cli::main),
    ("partition", posecut_partition::cli::main),
    ("pcm", posecut_pcm::cli::main),
    ("ransac", posecut_ransac::cli::main),
    ("readmit", posecut_readmit::cli::main),
    ("recognize", posecut_recognize::cli::main),
    ("report", posecut_report::cli::main),
    ("simulate", posecut_simulate::cli::main),
    ("simulate-graph", posecut_simulate_graph::cli::main),
    ("simulate-log", posecut_simulate_log::cli::main),
    ("verify", posecut_verify::cli::main),
    ("view", posecut_view::cli::main),
    ("voting", posecut_voting::cli::main),
];

/// The names of all.
pub fn names() -> Vec<&'static str> {
    PROGRAMS.iter().map(|(name, _)| *name).collect()
}

/// The program of a name.
pub(crate) fn get(name: &str) -> Option<Main> {
    PROGRAMS.iter().find(|(known, _)| *known == name).map(|(_, main)| *main)
}

//! What all posecut stage binaries share: reading and writing files and pipes, exit codes, logs, progress,
//! seeds, digests and provenance.
//!
//! The contract: `posecut-STAGE [OPTIONS] [INPUT] [-o OUTPUT]`, where `-` is standard input or output and
//! the default. Logs and progress go to standard error, a JSON summary to `--stats FILE`. Exit status 0:
//! done; 1: a check failed; 2: an error, reported in a sentence; 3: with `--strict`, done with doubts ([`Doubt`]). Output
//! appears whole or not at all. A closed pipe is no error. The same input, arguments and seed give the same bytes.
//!
//! A stage from graph to graph implements [`GraphStage`] and is run by [`run_graph_stage`]; everything else
//! describes its command line with clap and is run by [`run`].

mod arguments;
mod closing;
mod command_line;
mod context;
mod directory;
mod documentation;
mod doubt;
mod examples;
mod given;
mod graph_stage;
mod input;
mod interrupt;
mod logging;
mod output;
mod place;
mod program;
pub mod registry;
mod selection;
mod standard_output;
mod statistics;
mod threads;
mod usage;
mod words;

pub use arguments::{CommonArguments, Source, Target};
pub use closing::close;
pub use command_line::{arguments, set_arguments};
pub use context::{Context, Inside};
pub use directory::write_directory;
pub use doubt::Doubt;
pub use examples::Examples;
pub use graph_stage::{GraphStage, options, run_graph_stage};
pub use input::{Input, digest, open, open_file};
pub use output::{write_atomically, write_output};
pub use place::{Description, Phase, Place};
pub use program::{Identity, Outcome, answer, fail, run, run_with_doubts};
pub use selection::Selection;
pub use standard_output::hand_over_standard_output;
pub use statistics::Statistics;
pub use words::counted;

// Re-exported so that stages need no crates of their own for messages and progress.
pub use indicatif::ProgressBar;
pub use posecut_graph::{Expansion, LONGEST_LINE, bounded_lines};
pub use posecut_random::{ChaCha8Rng, rand, random};
pub use tracing::{debug, info, warn};

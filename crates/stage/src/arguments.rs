//! Arguments that every stage has.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Where bytes come from: a file, or `-` for standard input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// Standard input.
    Standard,
    /// A file.
    File(PathBuf),
}

/// Where bytes go: a file, or `-` for standard output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// Standard output.
    Standard,
    /// A file.
    File(PathBuf),
}

impl FromStr for Source {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(if text == "-" { Self::Standard } else { Self::File(text.into()) })
    }
}

impl FromStr for Target {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(if text == "-" { Self::Standard } else { Self::File(text.into()) })
    }
}

impl fmt::Display for Source {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard => formatter.write_str("standard input"),
            Self::File(path) => write!(formatter, "{}", path.display()),
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard => formatter.write_str("standard output"),
            Self::File(path) => write!(formatter, "{}", path.display()),
        }
    }
}

impl Target {
    /// The file, unless it is standard output.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Standard => None,
            Self::File(path) => Some(path),
        }
    }
}

/// Output, statistics, threads, how much is said, and what counts as success.
#[derive(Clone, Debug, clap::Args)]
pub struct CommonArguments {
    /// Write the result to this file; `-` is standard output, and a name ending in .gz is compressed
    #[arg(short, long, value_name = "FILE", default_value = "-", global = true, help_heading = "Output")]
    pub output: Target,

    /// Write a JSON summary of the run to this file
    #[arg(long, value_name = "FILE", global = true, help_heading = "Output")]
    pub stats: Option<PathBuf>,

    /// Use this many threads, or one for each processor if 0; the result is the same for any number
    #[arg(long, value_name = "N", default_value_t = 0, global = true, help_heading = "Output")]
    pub threads: usize,

    /// Exit with status 3 if the result is doubtful (see docs/doubts.md), after all output is written
    #[arg(long, global = true, help_heading = "Output")]
    pub strict: bool,

    /// Print only errors and doubts
    #[arg(short, long, conflicts_with = "verbose", global = true, help_heading = "Output")]
    pub quiet: bool,

    /// Print more messages
    #[arg(short, long, global = true, help_heading = "Output")]
    pub verbose: bool,
}

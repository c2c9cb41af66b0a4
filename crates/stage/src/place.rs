//! The position of a program in lists of programs.

use serde::{Deserialize, Serialize};

/// The purpose of a program. The order is that of a pipeline and of `posecut help`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// The program does everything that most users want with a graph of their own.
    Start,
    /// The program makes or converts graphs.
    Graphs,
    /// The program decides which landmark edges are wrong.
    Judgement,
    /// The program estimates poses.
    Optimisation,
    /// The program measures or shows results.
    Results,
    /// The program runs or checks other programs.
    Runs,
}

impl Phase {
    /// All phases, in order.
    pub const ALL: [Self; 6] =
        [Self::Start, Self::Graphs, Self::Judgement, Self::Optimisation, Self::Results, Self::Runs];

    /// The heading above the programs of this phase.
    pub const fn heading(self) -> &'static str {
        match self {
            Self::Start => "Start here with a graph of your own",
            Self::Graphs => "Make and convert graphs",
            Self::Judgement => "Find incorrect landmark edges",
            Self::Optimisation => "Estimate poses",
            Self::Results => "Measure and show results",
            Self::Runs => "Run and check other programs",
        }
    }
}

/// The position of a program in lists: its phase and its number in the phase. Lists sort by both, then by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place(pub Phase, pub u8);

/// The machine-readable description of a program: `posecut-STAGE --generate description` prints it as one line of JSON.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Description {
    /// The name without `posecut-`.
    pub name: String,
    /// The version.
    pub version: String,
    /// One sentence that says what the program does.
    pub about: String,
    /// The purpose of the program.
    pub phase: Phase,
    /// The number of the program in its phase.
    pub order: u8,
}

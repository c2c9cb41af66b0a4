//! Where a program stands among the others.

use serde::{Deserialize, Serialize};

/// What a program is for. The order is that of a pipeline, and of `posecut help`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// It makes graphs, or converts them.
    Graphs,
    /// It decides which landmark edges are wrong.
    Judgement,
    /// It finds poses.
    Optimisation,
    /// It measures results and shows them.
    Results,
    /// It runs or checks other programs.
    Runs,
}

impl Phase {
    /// All of them, in order.
    pub const ALL: [Self; 5] = [Self::Graphs, Self::Judgement, Self::Optimisation, Self::Results, Self::Runs];

    /// The heading of its programs.
    pub const fn heading(self) -> &'static str {
        match self {
            Self::Graphs => "Make and convert graphs",
            Self::Judgement => "Find wrong landmark edges",
            Self::Optimisation => "Find the poses",
            Self::Results => "Measure and show results",
            Self::Runs => "Run and check other programs",
        }
    }
}

/// The place of a program in lists: its phase, then its number in the phase, then its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place(pub Phase, pub u8);

/// What a program says of itself to programs: `posecut-STAGE --generate description`, one line of JSON.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Description {
    /// The name without `posecut-`.
    pub name: String,
    /// The version.
    pub version: String,
    /// One sentence on what it does.
    pub about: String,
    /// What it is for.
    pub phase: Phase,
    /// Its number in the phase.
    pub order: u8,
}

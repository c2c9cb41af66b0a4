//! What an examination finds.

use std::fmt;

use serde::Serialize;
use serde_json::{Map, Value};

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Programs refuse the graph, or their results mean nothing.
    Error,
    /// Results are probably worse than they could be.
    Warning,
    /// Good to know.
    Note,
}

/// What a finding is about, in the order of reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Topic {
    /// What was read, and what reading repaired.
    Input,
    /// Which edges are odometry.
    Odometry,
    /// Missing odometry, and times that jump.
    Gaps,
    /// Sessions, and which of them overlap.
    Sessions,
    /// Measured motions.
    Measurements,
    /// Information matrices.
    Information,
    /// Nodes and edges that occur twice.
    Duplicates,
    /// Distances between candidates, in frames.
    Spacing,
    /// Covariances compared with the truth.
    Truth,
    /// Factors on covariances, estimated from loops.
    Calibration,
    /// Given poses, and the axes of the map.
    Frames,
}

/// One finding, with its numbers, what follows from it, and what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// What it is about.
    pub topic: Topic,
    /// A name that stays the same between versions, such as `no-odometry`.
    pub name: &'static str,
    /// What was found, with its most important numbers.
    pub title: String,
    /// All numbers, by name; lengths in metres, angles in degrees.
    pub numbers: Map<String, Value>,
    /// What follows from it; empty for a plain note.
    pub consequence: String,
    /// What to do about it; empty if there is nothing to do.
    pub remedy: String,
}

impl Finding {
    /// A finding without numbers, consequence and remedy.
    pub fn new(severity: Severity, topic: Topic, name: &'static str, title: String) -> Self {
        let (consequence, remedy) = (String::new(), String::new());
        Self { severity, topic, name, title, numbers: Map::new(), consequence, remedy }
    }

    /// Adds a number; NaN and infinity become null.
    #[must_use]
    pub fn with(mut self, name: &str, number: impl Serialize) -> Self {
        self.numbers.insert(name.to_owned(), serde_json::to_value(number).unwrap_or(Value::Null));
        self
    }

    /// Says what follows from it, and what to do about it.
    #[must_use]
    pub fn therefore(mut self, consequence: impl Into<String>, remedy: impl Into<String>) -> Self {
        (self.consequence, self.remedy) = (consequence.into(), remedy.into());
        self
    }
}

impl Severity {
    /// The name, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

impl Topic {
    /// The name, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Odometry => "odometry",
            Self::Gaps => "gaps",
            Self::Sessions => "sessions",
            Self::Measurements => "measurements",
            Self::Information => "information",
            Self::Duplicates => "duplicates",
            Self::Spacing => "spacing",
            Self::Truth => "truth",
            Self::Calibration => "calibration",
            Self::Frames => "frames",
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

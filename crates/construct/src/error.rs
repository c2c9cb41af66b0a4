//! Requests that cannot be met.

use crate::IncorrectKind;

/// Why a multi-session graph cannot be constructed.
#[derive(Debug, thiserror::Error)]
pub enum ConstructError {
    /// An option has a value that means nothing.
    #[error("{option} is {value}, and must be {expected}")]
    Option {
        /// The option.
        option: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        expected: &'static str,
    },
    /// The graphs cannot stand in one file.
    #[error("{problem}; {remedy}")]
    Join {
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// A list of matches has a line that cannot be used.
    #[error("{file}:{line}: {problem}; {remedy}")]
    Matches {
        /// The list.
        file: String,
        /// Its line, from 1.
        line: u64,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// No node of some session knows where it truly was.
    #[error(
        "no node of the graph has truth, so nobody knows which viewpoints see the same place; ingest the session together with its ground truth"
    )]
    NoTruth,
    /// The experiences never come near each other.
    #[error(
        "no two viewpoints of different experiences lie within {radius} m and {heading} degrees of heading, so there is no landmark edge to construct; widen --radius or --heading, or take sessions that overlap"
    )]
    NoOverlap {
        /// Metres.
        radius: f64,
        /// Degrees.
        heading: f64,
    },
    /// There are not so many correct edges.
    #[error(
        "--correct-edges asks for {wanted} correct landmark edges, but only {found} pairs of viewpoints are spatially similar; lower it, or widen --radius or --heading"
    )]
    TooFewCorrectEdges {
        /// Edges asked for.
        wanted: usize,
        /// Pairs found.
        found: usize,
    },
    /// There are not so many odometry edges.
    #[error(
        "--odometry-gaps asks for {wanted} gaps, but the graph has only {found} odometry edges; lower it"
    )]
    TooFewOdometryEdges {
        /// Gaps asked for.
        wanted: usize,
        /// Odometry edges of all sessions.
        found: usize,
    },
    /// There are not so many wrong pairs.
    #[error(
        "a rate of {rate} asks for {wanted} {} landmark edges, but only {found} were found with --incorrect-distance {distance}; {remedy}",
        kind.words()
    )]
    TooFewWrongPairs {
        /// The rate asked for.
        rate: f64,
        /// Edges that it means.
        wanted: usize,
        /// Pairs found.
        found: usize,
        /// Which mistakes were asked for.
        kind: IncorrectKind,
        /// Metres.
        distance: f64,
        /// What to do about it.
        remedy: &'static str,
    },
}

//! Errors of construction.

use crate::IncorrectKind;

/// Why a multi-session graph cannot be constructed.
#[derive(Debug, thiserror::Error)]
pub enum ConstructError {
    /// An option has a meaningless value.
    #[error("{option} is {value}, and must be {expected}")]
    Option {
        /// The option.
        option: &'static str,
        /// The given value.
        value: f64,
        /// The allowed values.
        expected: &'static str,
    },
    /// The graphs cannot be put into one file.
    #[error("{problem}; {remedy}")]
    Join {
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// A list of matches has an unusable line.
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
    /// No node of some session has ground truth.
    #[error(
        "no node of the graph has truth, so nobody knows which viewpoints see the same place; ingest the session together with its ground truth"
    )]
    NoTruth,
    /// The experiences never come near each other.
    #[error(
        "no two viewpoints of different experiences lie within {radius} m and {heading} degrees of heading, so there is no landmark edge to construct; widen --radius or --heading, or take sessions that overlap"
    )]
    NoOverlap {
        /// The radius, metres.
        radius: f64,
        /// The heading, degrees.
        heading: f64,
    },
    /// There are fewer correct edges than requested.
    #[error(
        "--correct-edges asks for {wanted} correct landmark edges, but only {found} pairs of viewpoints are spatially similar; lower it, or widen --radius or --heading"
    )]
    TooFewCorrectEdges {
        /// Number of requested edges.
        wanted: usize,
        /// Number of pairs found.
        found: usize,
    },
    /// There are fewer odometry edges than requested.
    #[error(
        "--odometry-gaps asks for {wanted} gaps, but the graph has only {found} odometry edges; lower it"
    )]
    TooFewOdometryEdges {
        /// Number of requested gaps.
        wanted: usize,
        /// Number of odometry edges of all sessions.
        found: usize,
    },
    /// There are fewer wrong pairs than requested.
    #[error(
        "a rate of {rate} asks for {wanted} {} landmark edges, but only {found} were found with --incorrect-distance {distance}; {remedy}",
        kind.words()
    )]
    TooFewWrongPairs {
        /// The requested rate.
        rate: f64,
        /// Number of edges for that rate.
        wanted: usize,
        /// Number of pairs found.
        found: usize,
        /// The requested kind of mistakes.
        kind: IncorrectKind,
        /// The least distance, metres.
        distance: f64,
        /// What to do about it.
        remedy: &'static str,
    },
}

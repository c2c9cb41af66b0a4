//! Errors of construction.

use crate::IncorrectKind;

/// Why a multi-session graph cannot be constructed.
#[derive(Debug, thiserror::Error)]
pub enum ConstructError {
    /// An option has a meaningless value.
    #[error("{option} is {value}, but must be {expected}")]
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
        "no node of the graph has ground truth, so landmark edges cannot be constructed; ingest the sessions with their ground truth"
    )]
    NoTruth,
    /// The experiences never come near each other.
    #[error(
        "no two viewpoints of different experiences are within {radius} m and {heading} degrees of heading, so there are no landmark edges to construct; increase --radius or --heading, or use sessions that overlap"
    )]
    NoOverlap {
        /// The radius, metres.
        radius: f64,
        /// The heading, degrees.
        heading: f64,
    },
    /// There are fewer correct edges than requested.
    #[error(
        "--correct-edges is {wanted}, but the sessions give only {found}; decrease it, or increase --radius or --heading"
    )]
    TooFewCorrectEdges {
        /// Number of requested edges.
        wanted: usize,
        /// Number of pairs found.
        found: usize,
    },
    /// There are fewer odometry edges than requested.
    #[error(
        "--odometry-gaps is {wanted}, but must be at most {found}, the number of odometry edges; decrease it"
    )]
    TooFewOdometryEdges {
        /// Number of requested gaps.
        wanted: usize,
        /// Number of odometry edges of all sessions.
        found: usize,
    },
    /// There are fewer wrong pairs than requested.
    #[error(
        "too few incorrect landmark edges were found: {found} of {wanted} (--incorrect-rate {rate}, --incorrect-kind {}, --incorrect-distance {distance}); {remedy}",
        kind.name()
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

//! Files that cannot be used.

/// A sensor's file that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SensorError {
    /// A record violates the layout.
    #[error("{place}, record {record}: {problem}; {remedy}")]
    Record {
        /// The file.
        place: String,
        /// The record, counted from 1.
        record: usize,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The file as a whole is not usable.
    #[error("{place}: {problem}; {remedy}")]
    File {
        /// The file.
        place: String,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
}

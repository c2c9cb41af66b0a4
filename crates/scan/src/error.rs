//! Records that cannot be used.

/// A scan that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ScanError {
    /// The bytes could not be read.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// The file's name.
        source_name: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// A record is not a scan as the format describes it.
    #[error("{place}: {problem}; {remedy}")]
    Record {
        /// File and line, or the number of the record in its graph.
        place: String,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
}

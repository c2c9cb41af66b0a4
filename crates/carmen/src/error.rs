//! Logs that cannot be used.

/// A log that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The bytes could not be decompressed.
    #[error("{place}: cannot be decompressed: {error}; download it again if it is cut short")]
    Compression {
        /// The file.
        place: String,
        /// What the decoder says.
        error: std::io::Error,
    },
    /// A line is not a message as the format describes it.
    #[error("{place}, line {line}: {problem}; {remedy}")]
    Line {
        /// The file.
        place: String,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The log as a whole has not what a session needs.
    #[error("{place}: {problem}; {remedy}")]
    Log {
        /// The file.
        place: String,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// An option with a meaningless value.
    #[error("{option} is {value}, but must be {expected}")]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
}

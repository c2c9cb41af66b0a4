//! Errors of ingestion.

/// Why a session cannot be ingested: cause, file and remedy.
#[derive(Debug, thiserror::Error)]
pub enum IngestError {
    /// An option has a meaningless value.
    #[error("{option} is {value}, but must be a positive number")]
    Option {
        /// The option.
        option: &'static str,
        /// The given value.
        value: f64,
    },
    /// A file of a laser scanner is not usable.
    #[error(transparent)]
    Sensor(#[from] posecut_nclt_sensors::SensorError),
    /// The system could not read the bytes.
    #[error("{place}: cannot be read: {error}")]
    Io {
        /// File or archive.
        place: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// A row violates the layout.
    #[error("{file}, line {line}: {problem}; {remedy}")]
    Row {
        /// The CSV file.
        file: String,
        /// The line, counted from 1.
        line: u64,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// A file as a whole is not usable.
    #[error("{place}: {problem}; {remedy}")]
    Session {
        /// File, archive or directory.
        place: String,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
}

impl IngestError {
    pub(crate) fn session(place: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Session { place: place.to_owned(), problem: problem.into(), remedy: remedy.into() }
    }

    pub(crate) fn row(file: &str, line: u64, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Row { file: file.to_owned(), line, problem: problem.into(), remedy: remedy.into() }
    }
}

//! Errors that name the position, the problem and the remedy.

use std::fmt;

/// The file is not a valid pose graph, or cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The bytes could not be read.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// The file's name.
        source_name: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// The bytes are not a valid pose graph.
    #[error("{0}")]
    Format(Box<FormatProblem>),
}

/// Position, problem and remedy of an error in a file.
#[derive(Debug)]
pub struct FormatProblem {
    /// The file's name.
    pub source_name: String,
    /// The line, counted from 1; 0 where the whole file is meant.
    pub line: u64,
    /// The record, such as `landmark 2574`, if known.
    pub record: Option<String>,
    /// The field, if known.
    pub field: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
}

impl fmt::Display for FormatProblem {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.source_name)?;
        if self.line > 0 {
            write!(formatter, ", line {}", self.line)?;
        }
        if let Some(record) = &self.record {
            write!(formatter, ", {record}")?;
        }
        if let Some(field) = &self.field {
            write!(formatter, ", field \"{field}\"")?;
        }
        write!(formatter, ": {}; {}", self.problem, self.remedy)
    }
}

/// What is wrong with one record, before file and line are known.
#[derive(Debug)]
pub(crate) struct Problem {
    pub(crate) record: Option<String>,
    pub(crate) field: Option<String>,
    pub(crate) cause: String,
    pub(crate) remedy: String,
}

impl Problem {
    pub(crate) fn new(cause: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { record: None, field: None, cause: cause.into(), remedy: remedy.into() }
    }

    pub(crate) fn record(mut self, record: impl Into<String>) -> Self {
        self.record = Some(record.into());
        self
    }

    pub(crate) fn field(mut self, field: impl Into<String>) -> Self {
        self.field = Some(field.into());
        self
    }

    pub(crate) fn at(self, source_name: &str, line: u64) -> ReadError {
        ReadError::Format(Box::new(self.placed(source_name, line)))
    }

    pub(crate) fn placed(self, source_name: &str, line: u64) -> FormatProblem {
        FormatProblem {
            source_name: source_name.to_owned(),
            line,
            record: self.record,
            field: self.field,
            problem: self.cause,
            remedy: self.remedy,
        }
    }
}

/// A graph that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system refused the bytes.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// A number that JSON cannot represent. The program that computed it must be fixed.
    #[error(
        "{record}, field \"{field}\": the value is {value}, but a pose graph holds only finite numbers; check the input and the options of the stage, or report it as an error of the stage"
    )]
    NotFinite {
        /// The record, such as `node 17`.
        record: String,
        /// The field.
        field: &'static str,
        /// NaN or an infinity.
        value: f64,
    },
}

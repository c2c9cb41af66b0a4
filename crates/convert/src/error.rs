//! Errors of conversion.

/// Each error says what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ConvertError {
    /// The system could not read a line, or the line is not text.
    #[error("{file}, line {line}: cannot be read: {error}")]
    Io {
        /// The file.
        file: String,
        /// The line, counted from 1.
        line: u64,
        /// The system's error.
        error: std::io::Error,
    },
    /// A line violates the format.
    #[error("{file}, line {line}: {problem}; {remedy}")]
    Line {
        /// The file.
        file: String,
        /// The line, counted from 1.
        line: u64,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// The target format cannot hold the graph.
    #[error("{problem}; {remedy}")]
    Graph {
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
}

impl ConvertError {
    pub(crate) fn line(file: &str, line: u64, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Line { file: file.to_owned(), line, problem: problem.into(), remedy: remedy.into() }
    }

    pub(crate) fn graph(problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Graph { problem: problem.into(), remedy: remedy.into() }
    }
}

/// A finite number of a line.
pub(crate) fn number(file: &str, line: u64, text: &str) -> Result<f64, ConvertError> {
    let value: f64 = text.parse().map_err(|_| {
        ConvertError::line(file, line, format!("\"{text}\" is not a number"), "correct or delete the line")
    })?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ConvertError::line(file, line, format!("\"{text}\" is not finite"), "correct or delete the line"))
    }
}

/// Refuses a standard deviation that an option sets, unless one over its square is finite and positive.
pub(crate) fn check_sigma(option: &str, sigma: Option<f64>) -> Result<(), ConvertError> {
    match sigma {
        Some(sigma) if !(1e-50..=1e50).contains(&sigma) => Err(ConvertError::graph(
            format!("{option} is {sigma}"),
            "give a positive standard deviation, from 1e-50 to 1e50",
        )),
        _ => Ok(()),
    }
}

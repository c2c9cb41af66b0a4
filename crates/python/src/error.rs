//! Errors: one exception, with the sentence that the programs print.

use clap::Command;
use pyo3::PyErr;

// Python sees it as posecut.Error. The macro's code is not ours to lint.
pyo3::create_exception!(
    posecut,
    Error,
    pyo3::exceptions::PyException,
    "The sentence that a program of posecut would print: cause, place and remedy."
);

/// The exception for an error of a stage.
pub(crate) fn error(error: &anyhow::Error) -> PyErr {
    Error::new_err(format!("{error:#}"))
}

/// Parses options from words. An error is the sentence that the program prints.
pub(crate) fn parse<A: clap::Args>(program: &'static str, words: &[String]) -> anyhow::Result<A> {
    let command = A::augment_args(Command::new(program).no_binary_name(true).disable_help_flag(true));
    command
        .try_get_matches_from(words)
        .and_then(|matches| A::from_arg_matches(&matches))
        .map_err(|error| anyhow::anyhow!(sentence(program, &error)))
}

/// Shortens clap's message of several paragraphs to one line: the cause and its suggestions, without usage.
fn sentence(program: &str, error: &clap::Error) -> String {
    let text = error.render().to_string();
    let ends = ["\n\nUsage:", "\n\nFor more information"].map(|end| text.find(end).unwrap_or(text.len()));
    let said = &text[..ends.into_iter().fold(text.len(), usize::min)];
    let one_line = |paragraph: &str| {
        paragraph.split_whitespace().filter(|word| *word != "tip:").collect::<Vec<_>>().join(" ")
    };
    let paragraphs = said.trim_start_matches("error: ").split("\n\n").flat_map(|part| part.split("\n  tip:"));
    let cause: Vec<String> = paragraphs.map(one_line).filter(|part| !part.is_empty()).collect();
    format!("{}; posecut-{program} --help lists the options", cause.join("; "))
}

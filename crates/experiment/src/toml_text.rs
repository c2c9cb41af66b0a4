//! TOML files, with errors in one sentence.

use anyhow::anyhow;
use serde::de::DeserializeOwned;

/// Parses a text. An error is one sentence that names the line; the library's own message takes several lines.
pub(crate) fn parse<T: DeserializeOwned>(text: &str) -> anyhow::Result<T> {
    toml::from_str(text).map_err(|error| {
        let message = error.message().split_whitespace().collect::<Vec<_>>().join(" ");
        match error.span() {
            Some(span) => {
                let before = text.as_bytes().iter().take(span.start);
                anyhow!("line {}: {message}; correct it", before.filter(|byte| **byte == b'\n').count() + 1)
            }
            None => anyhow!("{message}; correct it"),
        }
    })
}

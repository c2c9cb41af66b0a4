//! Published figures, for comparison with ours.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, anyhow, bail};
use serde::Deserialize;

/// A published table of RMSE values.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Where it was published.
    pub source: String,
    /// RMSE in metres, by method and session.
    pub rmse: BTreeMap<String, BTreeMap<String, f64>>,
}

impl Published {
    /// Reads a TOML file; numbers must be finite.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let place = path.display();
        let text = std::fs::read_to_string(path).with_context(|| format!("{place}: cannot be read"))?;
        let published: Self = toml::from_str(&text).map_err(|error| {
            // The library's full message is a drawing of several lines; take only its text.
            let message = error.message().split_whitespace().collect::<Vec<_>>().join(" ");
            let before = |end: usize| text.as_bytes().iter().take(end).filter(|byte| **byte == b'\n').count();
            let line = error.span().map_or_else(String::new, |span| format!(", line {}", before(span.start) + 1));
            let field = error.span().map_or_else(String::new, |span| field(&text[..span.start]));
            anyhow!("{place}{line}{field}: {message}; expected source = \"…\" and [rmse.METHOD] tables of SESSION = METRES")
        })?;
        for (method, row) in &published.rmse {
            if let Some((session, value)) = row.iter().find(|(_, value)| !value.is_finite()) {
                bail!("{place}: rmse.{method}.{session} is {value}, but must be a finite number");
            }
        }
        Ok(published)
    }

    /// The published value of a method on a session.
    pub fn value(&self, method: &str, session: &str) -> Option<f64> {
        self.rmse.get(method)?.get(session).copied()
    }

    /// The mean of a method over its published sessions.
    pub fn mean(&self, method: &str) -> Option<f64> {
        let row = self.rmse.get(method).filter(|row| !row.is_empty())?;
        Some(row.values().sum::<f64>() / row.len() as f64)
    }
}

/// The field that the end of a text defines: the table, and the key if its value comes next.
fn field(before: &str) -> String {
    let header = |line: &&str| line.starts_with('[');
    let table = before.lines().map(str::trim).rfind(header).map(|line| line.trim_matches(['[', ']']));
    let last = before.rsplit('\n').next().unwrap_or_default();
    let key = last.split_once('=').map(|(key, _)| key.trim());
    let parts: Vec<&str> = table.into_iter().chain(key).collect();
    if parts.is_empty() { String::new() } else { format!(", {}", parts.join(".")) }
}

//! Graphs that a program draws, another one for every seed.

use serde::Deserialize;

use crate::declaration::words;

/// Drawn graphs with one set of options.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drawn {
    /// Their name in results, beside the seed.
    pub name: String,
    /// Options of the step `simulate-graph`, after those of `[stages]`.
    #[serde(default)]
    pub options: String,
}

impl Drawn {
    /// The options as words.
    pub(crate) fn words(&self) -> Vec<String> {
        words(&self.options)
    }
}

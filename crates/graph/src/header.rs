//! The first line of a file: format, dimension, shared noise models and provenance.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{Dimension, Extra};

/// The header record.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Plane or space, for all records of the file.
    pub dimension: Dimension,
    /// Information matrices that edges share by name (`"noise":"odometry"`), in the order read.
    pub noise_models: Vec<(String, NoiseModel)>,
    /// What each stage did so far, oldest first. Entries are kept as read, because other people's stages may write other fields.
    pub provenance: Vec<Value>,
    /// Unknown fields, passed through.
    pub extra: Extra,
}

impl Header {
    /// A header without history.
    pub fn new(dimension: Dimension) -> Self {
        Self { dimension, noise_models: Vec::new(), provenance: Vec::new(), extra: Extra::new() }
    }

    /// The noise model of that name.
    pub fn noise_model(&self, name: &str) -> Option<&NoiseModel> {
        self.noise_models.iter().find(|(known, _)| known == name).map(|(_, model)| model)
    }

    /// The doubts that the stages raised, oldest first, each once. Entries of an unknown layout have none.
    pub fn doubts(&self) -> Vec<StageDoubt> {
        let mut found: Vec<StageDoubt> = Vec::new();
        for entry in &self.provenance {
            let Some(stage) = entry.get("stage").and_then(Value::as_str) else { continue };
            for doubt in doubts_of(entry) {
                let own = StageDoubt { stage: stage.to_owned(), doubt: doubt.to_owned() };
                if !found.contains(&own) {
                    found.push(own);
                }
            }
        }
        found
    }

    /// Adds one stage's entry at the end of the history.
    pub fn push_provenance(&mut self, entry: &Provenance) {
        // A struct of strings, numbers and values always converts.
        if let Ok(value) = serde_json::to_value(entry) {
            self.provenance.push(value);
        }
    }
}

/// An information matrix with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseModel {
    /// Upper triangle, row-major, 6 or 21 terms.
    pub information: Vec<f64>,
    /// Unknown fields, passed through.
    pub extra: Extra,
}

/// What one stage did, in enough detail to repeat it. It holds no wall times, host names or paths, so that the same
/// input, arguments and seed give the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The stage's name, such as `pcm`.
    pub stage: String,
    /// The stage's version.
    pub version: String,
    /// The options that shape the result.
    pub arguments: Value,
    /// The seed of its random numbers, if it drew any.
    pub seed: Option<u64>,
    /// The files it read.
    pub inputs: Vec<InputDigest>,
    /// The names of its doubts about the result. The field is absent if there are none, and in files of older programs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<String>,
}

/// The names of the doubts in an entry of the history. An entry of an unknown layout has none.
pub fn doubts_of(entry: &Value) -> impl Iterator<Item = &str> {
    entry.get("doubts").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str)
}

/// A doubt about a result, and the stage that raised it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct StageDoubt {
    /// The stage's name.
    pub stage: String,
    /// The doubt's name.
    pub doubt: String,
}

/// A file that a stage read, by role and content.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InputDigest {
    /// The role of the input (`graph`) or the file's own name without folders.
    pub name: String,
    /// SHA-256 of the content, decompressed, in hexadecimal.
    pub sha256: String,
}

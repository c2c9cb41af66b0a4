//! Errors of measured relations, as `posecut-evaluate --relations` writes them.

use anyhow::Context as _;
use serde::Deserialize;

use crate::results::check_format;

/// Errors of relative motions (Kuemmerle et al., Autonomous Robots 27, 2009).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct RelationErrors {
    /// Relations compared.
    pub compared: usize,
    /// Lengths of the errors' translations, metres; `None` if nothing was compared.
    pub translation_m: Option<Spread>,
    /// Angles of the errors' rotations, radians; `None` if nothing was compared.
    pub rotation_rad: Option<Spread>,
}

/// Mean and standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub std: f64,
}

/// The fields of a result that matter here. Its `rmse` is null where nothing but relations is known.
#[derive(Deserialize)]
struct Evaluation {
    format: String,
    version: u64,
    relations: Option<RelationErrors>,
}

/// Reads a result; `name` is what messages call it.
pub(super) fn errors(name: &str, bytes: &[u8]) -> anyhow::Result<Option<RelationErrors>> {
    let result: Evaluation = serde_json::from_slice(bytes)
        .with_context(|| format!("{name}: is not a result; write it with posecut-evaluate --relations"))?;
    check_format(name, &result.format, result.version)?;
    Ok(result.relations)
}

//! Results of many runs in one file.

use std::io::Write;
use std::path::Path;

use anyhow::{Context as _, bail};
use serde_json::{Map, Value};

use crate::Plan;

/// What of a result is kept: what tables and maps need, without history and per-session detail.
const KEPT: &[&str] =
    &["format", "version", "labels", "rmse", "components", "poses", "poses_unmatched", "edges"];

/// Writes the results of a plan that are there, one a line, in the plan's order. Returns how many there are, and
/// how many are missing.
pub fn collect(plan: &Plan, mut writer: impl Write) -> anyhow::Result<(usize, usize)> {
    let (mut found, mut missing) = (0, 0);
    for path in plan.results() {
        let bytes = match std::fs::read(Path::new(path)) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                missing += 1;
                continue;
            }
            Err(error) => return Err(error).with_context(|| format!("{path}: cannot be read")),
        };
        let all: Map<String, Value> = serde_json::from_slice(&bytes)
            .with_context(|| format!("{path}: is no result; run the experiment again"))?;
        if all.get("format").and_then(Value::as_str) != Some("posecut-result") {
            bail!("{path}: is no result of posecut-evaluate; run the experiment again");
        }
        let kept: Map<String, Value> =
            all.into_iter().filter(|(name, _)| KEPT.contains(&name.as_str())).collect();
        serde_json::to_writer(&mut writer, &kept)?;
        writer.write_all(b"\n")?;
        found += 1;
    }
    Ok((found, missing))
}

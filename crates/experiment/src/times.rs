//! CPU seconds of tasks, one line a task, in a file beside its group. They differ from run to run, so they have their own files.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use anyhow::Context as _;
use posecut_stage::write_atomically;
use serde::{Deserialize, Serialize};

use crate::append::append;

/// A task and its time.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Time {
    id: String,
    digest: String,
    cpu_seconds: f64,
}

fn path(group: &str) -> PathBuf {
    PathBuf::from(format!("{group}.times.jsonl"))
}

/// Appends the time of a task. Of several lines for one task, the last one counts.
pub(crate) fn add(group: &str, id: &str, digest: &str, cpu_seconds: f64) -> anyhow::Result<()> {
    append(&path(group), &Time { id: id.to_owned(), digest: digest.to_owned(), cpu_seconds })
}

/// The times of a group's tasks by id, with the digest of each task.
pub(crate) fn read(group: &str) -> anyhow::Result<BTreeMap<String, (String, f64)>> {
    let path = path(group);
    let bytes = match fs::read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(error).with_context(|| format!("{}: cannot be read", path.display())),
    };
    // Skip a damaged line: only a time is lost, not a result.
    let times =
        bytes.split(|byte| *byte == b'\n').filter_map(|line| serde_json::from_slice::<Time>(line).ok());
    Ok(times.map(|time| (time.id, (time.digest, time.cpu_seconds))).collect())
}

/// Writes one line a task, in the order of their ids.
pub(crate) fn sort(group: &str) -> anyhow::Result<()> {
    let times = read(group)?;
    if times.is_empty() {
        return Ok(());
    }
    write_atomically(&path(group), |writer| {
        for (id, (digest, cpu_seconds)) in times {
            serde_json::to_writer(&mut *writer, &Time { id, digest, cpu_seconds })?;
            writer.write_all(b"\n")?;
        }
        Ok(())
    })
}

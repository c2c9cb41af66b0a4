//! The journal of finished tasks: one line a task, in a file beside the group of the task.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use posecut_stage::{counted, warn, write_atomically};
use serde::{Deserialize, Serialize};

use crate::append::append;

/// A finished task.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Entry {
    pub(crate) id: String,
    pub(crate) digest: String,
    /// SHA-256 of each output.
    pub(crate) outputs: BTreeMap<String, String>,
    /// For a failed run, why the task has no outputs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) failed: Option<String>,
}

/// The finished tasks of some groups. A line is appended when a task finishes, so that a killed run loses nothing. At the end
/// of the run the lines are sorted, so that a resumed run leaves the same bytes as an undisturbed one.
#[derive(Default)]
pub(crate) struct Journals(HashMap<String, BTreeMap<String, Entry>>);

fn path(group: &str) -> PathBuf {
    PathBuf::from(format!("{group}.tasks.jsonl"))
}

impl Journals {
    pub(crate) fn load(&mut self, group: &str) -> anyhow::Result<()> {
        if self.0.contains_key(group) {
            return Ok(());
        }
        let path = path(group);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(error).with_context(|| format!("{}: cannot be read", path.display())),
        };
        let (entries, damaged) = read(&path, &bytes);
        if damaged {
            set_aside(&path, &bytes)?;
        }
        if damaged || lines(&bytes).count() != entries.len() {
            write(&path, &entries)?;
        }
        self.0.insert(group.to_owned(), entries);
        Ok(())
    }

    pub(crate) fn get(&self, group: &str, id: &str) -> Option<&Entry> {
        self.0.get(group)?.get(id)
    }

    pub(crate) fn add(&mut self, group: &str, entry: Entry) -> anyhow::Result<()> {
        append(&path(group), &entry)?;
        self.0.entry(group.to_owned()).or_default().insert(entry.id.clone(), entry);
        Ok(())
    }

    /// Writes a group's lines in the order of their task ids.
    pub(crate) fn sort(&self, group: &str) -> anyhow::Result<()> {
        // A group without a finished task may have no folder.
        self.0
            .get(group)
            .filter(|entries| !entries.is_empty())
            .map_or(Ok(()), |entries| write(&path(group), entries))
    }
}

fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    bytes.split(|byte| *byte == b'\n').filter(|line| !line.trim_ascii().is_empty())
}

/// The readable tasks of a journal, and whether a line is damaged. An incomplete last line does not count as damage: a killed
/// run leaves one.
fn read(path: &Path, bytes: &[u8]) -> (BTreeMap<String, Entry>, bool) {
    let mut entries = BTreeMap::new();
    let mut broken: Vec<usize> = Vec::new();
    let unfinished = !bytes.ends_with(b"\n");
    let mut numbered = (1..).zip(bytes.split(|byte| *byte == b'\n')).peekable();
    while let Some((number, line)) = numbered.next() {
        if line.trim_ascii().is_empty() {
            continue;
        }
        match serde_json::from_slice::<Entry>(line) {
            Ok(entry) => {
                entries.insert(entry.id.clone(), entry);
            }
            Err(_) if unfinished && numbered.peek().is_none() && line.starts_with(b"{") => {}
            Err(_) => broken.push(number),
        }
    }
    if let Some(first) = broken.first() {
        warn!(
            "{}, line {first}: is not the record of a finished task; ignored {}: the tasks run again",
            path.display(),
            counted(broken.len(), "such line")
        );
    }
    (entries, !broken.is_empty())
}

/// Keeps a damaged journal under another name, because somebody may need what is in it.
fn set_aside(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let mut name = path.as_os_str().to_owned();
    name.push(".damaged");
    let aside = PathBuf::from(name);
    write_atomically(&aside, |writer| Ok(writer.write_all(bytes)?))?;
    warn!("{}: a copy of the damaged file is kept here", aside.display());
    Ok(())
}

fn write(path: &Path, entries: &BTreeMap<String, Entry>) -> anyhow::Result<()> {
    write_atomically(path, |writer| {
        for entry in entries.values() {
            serde_json::to_writer(&mut *writer, entry)?;
            writer.write_all(b"\n")?;
        }
        Ok(())
    })
}

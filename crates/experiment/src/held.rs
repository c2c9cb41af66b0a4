//! Checks that a plan writes nothing outside the folders of results and simulated sessions, even through links.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context as _, bail};

use crate::{Plan, Source};

/// The endings of the files that the runner writes beside a group.
const BESIDE: [&str; 3] = ["tasks.jsonl", "tasks.jsonl.damaged", "times.jsonl"];

/// Refuses a plan that would write a file elsewhere.
pub(crate) fn check(plan: &Plan, source: &Source) -> anyhow::Result<()> {
    let roots = [resolved(&source.results)?, resolved(&source.simulated)?];
    let mut folders: HashMap<PathBuf, PathBuf> = HashMap::new();
    for task in &plan.tasks {
        let beside = BESIDE.map(|ending| format!("{}.{ending}", task.group));
        for file in task.outputs.iter().chain(&task.statistics).chain(&beside) {
            let path = Path::new(file);
            let real = if path.is_symlink() { resolved(path)? } else { in_folder(path, &mut folders)? };
            if !roots.iter().any(|root| real.starts_with(root) && real != *root) {
                bail!(
                    "{file}: would be written as {}, outside the folders of --results and --simulated; name its folder with one of these options, or remove the link that leads there",
                    real.display()
                );
            }
        }
    }
    Ok(())
}

/// The resolved path of a file that is not a link itself. Each folder is resolved once.
fn in_folder(path: &Path, folders: &mut HashMap<PathBuf, PathBuf>) -> anyhow::Result<PathBuf> {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return resolved(path) };
    if !folders.contains_key(folder) {
        folders.insert(folder.to_owned(), resolved(folder)?);
    }
    Ok(folders[folder].join(name))
}

/// Resolves all links of a path. Its last parts need not exist yet.
fn resolved(path: &Path) -> anyhow::Result<PathBuf> {
    let place = || format!("{}: cannot be resolved; name another folder", path.display());
    let mut existing = path;
    let mut missing = Vec::new();
    loop {
        let start = if existing.as_os_str().is_empty() { Path::new(".") } else { existing };
        match std::fs::canonicalize(start) {
            Ok(real) => return Ok(missing.iter().rev().fold(real, |real, part| real.join(part))),
            Err(_) if start.is_symlink() => {
                bail!("{}: is a link that cannot be followed; remove it", start.display())
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                let part = existing.components().next_back().with_context(place)?;
                if part == Component::ParentDir {
                    // Once the missing folder exists, the path would lead elsewhere.
                    bail!(
                        "{}: leads back (..) out of a folder that does not exist; name it directly",
                        path.display()
                    );
                }
                missing.push(part);
                existing = existing.parent().with_context(place)?;
            }
            Err(error) => return Err(error).with_context(place),
        }
    }
}

//! Digests of files, folders and tasks.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use posecut_stage::digest;

/// The SHA-256 of a file, or of a folder: the names and digests of its files.
pub(crate) fn digest_path(path: &Path) -> anyhow::Result<String> {
    let place = || format!("{}: cannot be read", path.display());
    if path.is_dir() {
        let mut names: Vec<PathBuf> = std::fs::read_dir(path)
            .with_context(place)?
            .map(|entry| Ok(entry?.path()))
            .collect::<std::io::Result<_>>()
            .with_context(place)?;
        names.sort();
        let mut text = String::new();
        for name in names {
            let file = name.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            text.push_str(&format!("{file} {}\n", digest_path(&name)?));
        }
        return Ok(digest(text.as_bytes()));
    }
    Ok(digest(&std::fs::read(path).with_context(place)?))
}

/// Digests of files that do not change while a plan is made, each computed once.
#[derive(Default)]
pub(crate) struct Digests(HashMap<PathBuf, String>);

impl Digests {
    pub(crate) fn of(&mut self, path: &Path) -> anyhow::Result<String> {
        if let Some(known) = self.0.get(path) {
            return Ok(known.clone());
        }
        let found = digest_path(path)?;
        self.0.insert(path.to_owned(), found.clone());
        Ok(found)
    }
}

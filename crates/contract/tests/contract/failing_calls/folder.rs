//! The files of a folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// File contents by path. Paths of folders end in `/`, and their content is empty.
pub(super) type Files = BTreeMap<PathBuf, Vec<u8>>;

/// Everything below a folder.
pub(super) fn files(root: &Path) -> Files {
    fn gather(folder: &Path, root: &Path, files: &mut Files) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root).unwrap();
            if path.is_dir() {
                gather(&path, root, files);
                // Add the folder itself, so that an empty one is not overlooked.
                files.insert(name.join(""), Vec::new());
            } else {
                files.insert(name.to_owned(), std::fs::read(&path).unwrap());
            }
        }
    }
    let mut files = Files::new();
    gather(root, root, &mut files);
    files
}

pub(super) fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            std::fs::create_dir(&target).unwrap();
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), &target).unwrap();
        }
    }
}

/// Whether the bytes are JSON: one value, or one value on each complete line.
pub(super) fn is_json(bytes: &[u8]) -> bool {
    let value = |bytes: &[u8]| serde_json::from_slice::<serde_json::Value>(bytes).is_ok();
    bytes.is_empty()
        || bytes.ends_with(b"\n") && (value(bytes) || bytes.trim_ascii().split(|b| *b == b'\n').all(value))
}

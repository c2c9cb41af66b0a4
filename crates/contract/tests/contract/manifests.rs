//! Tests that a target without tests in `cargo test` (`test = false` in its manifest, to save a second compilation) really
//! contains none.

use std::path::{Path, PathBuf};

use posecut_contract::workspace;

/// All Rust files below a folder.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// Whether a section of a manifest says `test = false`.
fn excluded(manifest: &str, section: &str) -> bool {
    manifest
        .lines()
        .skip_while(|line| *line != section)
        .skip(1)
        .take_while(|line| !line.starts_with('['))
        .any(|line| line == "test = false")
}

#[test]
fn no_test_is_left_out() {
    for entry in std::fs::read_dir(workspace().join("crates")).unwrap().flatten() {
        let folder = entry.path();
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let (library, program) = (excluded(&manifest, "[lib]"), excluded(&manifest, "[[bin]]"));
        for file in rust_files(&folder.join("src")) {
            let main = file.file_name().is_some_and(|name| name == "main.rs");
            let text = std::fs::read_to_string(&file).unwrap();
            let tests = text.contains("#[test]") || text.contains("proptest!");
            let left_out = if main { program } else { library };
            assert!(
                !(tests && left_out),
                "{}: its tests do not run; remove `test = false` from {}/Cargo.toml",
                file.display(),
                folder.display()
            );
        }
    }
}

//! Runs the program on files of a folder.

use std::path::Path;
use std::process::Command;

use posecut_graph::PoseGraph;
use tempfile::TempDir;

/// A folder with these files.
pub(crate) fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

/// The graph that the program writes, and what it says on standard error.
pub(crate) fn converted(folder: &Path, arguments: &[&str]) -> (PoseGraph, String) {
    let output = run(folder, arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments:?}: {said}");
    (PoseGraph::read("output", output.stdout.as_slice()).unwrap(), said)
}

/// The sentence with which the program refuses. Nothing is on standard output.
pub(crate) fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    let last = said.lines().last().unwrap();
    assert!(last.starts_with("posecut-convert: error: "), "{said}");
    last.to_owned()
}

fn run(folder: &Path, arguments: &[&str]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_posecut-convert"))
        .args(arguments)
        .current_dir(folder)
        .stdin(std::process::Stdio::null())
        .output()
        .unwrap()
}

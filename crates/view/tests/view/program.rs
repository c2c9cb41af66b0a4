//! The program: its inputs, outputs and errors.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::data;
use crate::graphs::{Content, graph, statistics};

fn saved(folder: &Path, name: &str, content: Content) -> String {
    let path = folder.join(name);
    graph(content).write(fs::File::create(&path).unwrap()).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Runs the program with an input on standard input: success, standard output, standard error.
fn run(arguments: &[&str], input: &[u8]) -> (bool, String, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_posecut-view"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The program may refuse its input before it has read it.
    let _ = child.stdin.take().unwrap().write_all(input);
    let output = child.wait_with_output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.success(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_pipe_and_a_file_give_the_same_page() {
    let folder = tempfile::tempdir().unwrap();
    let path = saved(folder.path(), "graph.jsonl", Content::default());
    let page = folder.path().join("page.html");
    let (done, _, said) = run(&[&path, "-o", page.to_str().unwrap()], b"");
    assert!(done, "{said}");
    assert!(said.contains("80 nodes, 27 landmark edges: 10 in use, 1 undecided, 16 rejected"), "{said}");
    let (done, piped, _) = run(&["-q", "-", "--threads", "1"], &fs::read(&path).unwrap());
    let written = fs::read_to_string(&page).unwrap();
    assert!(done && piped == written);
    assert!(!written.contains(folder.path().to_str().unwrap()), "no path is shown");
}

#[test]
fn poses_before_and_statistics_come_from_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = saved(folder.path(), "graph.jsonl", Content::default());
    let before = saved(folder.path(), "before.jsonl", Content { hypothesis: 1, ..Content::default() });
    let stats = folder.path().join("stats.json");
    fs::write(&stats, serde_json::to_vec(&statistics()).unwrap()).unwrap();
    let stats = stats.to_str().unwrap();
    let (done, page, said) =
        run(&[&path, "--before", &before, "--verify-stats", stats, "--frame", "ned", "--title", "Mine"], b"");
    assert!(done, "{said}");
    let data = data(&page);
    assert_eq!(data["before"]["reckoned"], false);
    assert_eq!(data["verification"]["rivals"][0]["hypothesis"], 1.0);
    assert_eq!(data["planes"][0]["right"]["name"], "y, east");
    assert!(page.contains("<title>Mine</title>"));
}

#[test]
fn errors_are_sentences() {
    let folder = tempfile::tempdir().unwrap();
    let path = saved(folder.path(), "graph.jsonl", Content::default());
    let said = |arguments: &[&str]| {
        let (done, page, said) = run(arguments, b"");
        assert!(!done && page.is_empty());
        said
    };
    assert!(said(&["-", "--before", "-"]).contains("only one input can be standard input"));
    assert!(said(&[&path, "--verify-stats", &path]).contains("is not a JSON object"));
    assert!(said(&[&path, "-o", &path]).contains("would overwrite"));
    let space = saved(folder.path(), "space.jsonl", Content { dimension: 3, ..Content::default() });
    assert!(said(&[&path, "--before", &space]).contains("dimension 2 and 3"));
    let other = folder.path().join("other.json");
    fs::write(&other, "{\"stage\":\"pcm\"}").unwrap();
    let (done, _, said) = run(&[&path, "--verify-stats", other.to_str().unwrap()], b"");
    assert!(done && said.contains("does not come from posecut-verify"), "{said}");
}

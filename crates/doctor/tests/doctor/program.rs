//! The program: formats, exit statuses, statistics, hostile names.

use std::fs::File;
use std::path::Path;
use std::process::{Command, Output};

use posecut_graph::{EdgeKind, PoseGraph};
use serde_json::Value;

use crate::drives::{edges_of, plane, split};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_posecut-doctor")).args(arguments).output().unwrap()
}

fn write(graph: &PoseGraph, folder: &Path, name: &str) -> String {
    let path = folder.join(name);
    graph.write(File::create(&path).unwrap()).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn strict_fails_for_warnings_and_not_for_notes() {
    let folder = tempfile::tempdir().unwrap();
    let good = write(&plane(), folder.path(), "good.jsonl");
    let mut graph = plane();
    edges_of(&mut graph, EdgeKind::Odometry)
        .for_each(|edge| edge.information = Some(vec![1.0, 0.0, 0.0, 1.0, 0.0, 1.0]));
    let bad = write(&graph, folder.path(), "bad.jsonl");
    for (path, arguments, status) in
        [(&good, vec![], 0), (&good, vec!["--strict"], 0), (&bad, vec![], 0), (&bad, vec!["--strict"], 1)]
    {
        let output = run(&[&[path.as_str()][..], &arguments].concat());
        assert_eq!(output.status.code(), Some(status), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn the_report_says_what_follows_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let mut graph = plane();
    graph.edges.retain(|edge| edge.kind == EdgeKind::Landmark);
    let path = write(&graph, folder.path(), "graph.jsonl");
    let (report, stats) = (folder.path().join("report.txt"), folder.path().join("stats.json"));
    let output = run(&[path.as_str(), "-o", report.to_str().unwrap(), "--stats", stats.to_str().unwrap()]);
    assert!(output.status.success() && output.stdout.is_empty());
    let text = std::fs::read_to_string(report).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "240 nodes, 0 odometry edges, 120 landmark edges, in the plane");
    let error = lines.iter().position(|line| line.starts_with("error (odometry): no odometry edge")).unwrap();
    assert!(lines[error + 1].starts_with("  consequence: every node is a chain"), "{text}");
    assert!(lines[error + 2].starts_with("  remedy: add odometry edges"), "{text}");
    assert!(lines.last().unwrap().starts_with("1 error, "), "{text}");
    let stats: Value = serde_json::from_slice(&std::fs::read(stats).unwrap()).unwrap();
    assert_eq!(stats["errors"], 1);
    let first = &stats["findings"][0];
    assert_eq!(
        (&first["severity"], &first["topic"], &first["name"]),
        (&"error".into(), &"odometry".into(), &"no-odometry".into())
    );
    assert_eq!(first["numbers"]["nodes"], 240);
}

/// A g2o file whose ids count by 10: its odometry is inferred, and repaired matrices are a finding.
#[test]
fn other_formats_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("graph.g2o");
    let mut text = String::new();
    for node in 0..9 {
        text += &format!("VERTEX_SE2 {} {node} 0 0\n", 10 * node);
    }
    for node in 0..8 {
        let matrix = if node == 3 { "1 2 0 1 0 1" } else { "400 0 0 400 0 2500" };
        text += &format!("EDGE_SE2 {} {} 1 0 0 {matrix}\n", 10 * node, 10 * node + 10);
    }
    text += "EDGE_SE2 0 80 8 0 0 100 0 0 100 0 400\n";
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap();
    assert_eq!(run(&[path]).status.code(), Some(2), "an indefinite matrix is refused");
    let output = run(&[path, "--repair-information", "--strict"]);
    let report = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{report}");
    assert!(
        report.contains("8 odometry edges, between 8 of 8 pairs of consecutive nodes; ids count by 10"),
        "{report}"
    );
    assert!(report.contains("warning (input): "), "{report}");
    assert!(report.contains("  remedy: export the sensor's own covariances"), "{report}");
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn names_of_sessions_cannot_control_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let mut graph = split(plane());
    for node in &mut graph.nodes {
        node.session = node.session.as_ref().map(|name| format!("\u{1b}[31m{name}\n\u{9b}"));
    }
    let output = run(&[&write(&graph, folder.path(), "graph.jsonl")]);
    let report = String::from_utf8(output.stdout).unwrap();
    assert!(report.contains("[31ma and [31mb: 120"), "{report}");
    assert!(report.chars().all(|character| character == '\n' || !character.is_control()), "{report:?}");
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(&split(plane()), folder.path(), "graph.jsonl");
    assert_eq!(run(&[&path, "--threads", "1"]).stdout, run(&[&path, "--threads", "2"]).stdout);
}

#[test]
fn the_report_may_not_replace_its_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(&plane(), folder.path(), "graph.jsonl");
    let output = run(&[&path, "-o", &path]);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
}

//! The program: streams and files in canonical form, retracted edges, intermediate estimates, bad input.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::PoseGraph;
use posecut_optimize::{Options, Problem, optimize};

pub(crate) const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;
const INFORMATION: &str = "[100,0,0,100,0,400]";

pub(crate) fn node(id: u64, utime: i64) -> String {
    format!(r#"{{"kind":"node","id":{id},"session":"a","utime":{utime},"pose":[0,0,0]}}"#)
}

pub(crate) fn edge(kind: &str, id: u64, from: u64, to: u64, measurement: &str) -> String {
    format!(
        r#"{{"kind":"{kind}","id":{id},"from":{from},"to":{to},"measurement":{measurement},"information":{INFORMATION}}}"#
    )
}

/// A square of four steps, with a false diagonal edge (6) that is retracted, and a true closing edge (5).
fn square() -> Vec<String> {
    let step = "[1,0.01,1.57]";
    vec![
        HEADER.to_owned(),
        node(0, 10),
        node(1, 20),
        edge("odometry", 0, 0, 1, step),
        node(2, 30),
        edge("odometry", 1, 1, 2, step),
        edge("landmark", 6, 0, 2, "[9,9,0]"),
        node(3, 40),
        edge("odometry", 2, 2, 3, step),
        r#"{"kind":"retract","edge":6,"why":"the front end thought better of it"}"#.to_owned(),
        edge("landmark", 5, 3, 0, "[1,0,1.57]"),
    ]
}

pub(crate) fn run(lines: &[String], arguments: &[&str]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_posecut-isam"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let _ = child.stdin.take().unwrap().write_all((lines.join("\n") + "\n").as_bytes());
    child.wait_with_output().unwrap()
}

/// Standard output of a run that must succeed.
pub(crate) fn follow(lines: &[String], arguments: &[&str]) -> String {
    let output = run(lines, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a run that must fail.
pub(crate) fn refuse(lines: &[String], arguments: &[&str]) -> String {
    let output = run(lines, arguments);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr).unwrap()
}

/// The poses of the nodes.
pub(crate) fn poses(graph: &str) -> Vec<Vec<f64>> {
    let pose = |line: &str| {
        let record: serde_json::Value = serde_json::from_str(line).unwrap();
        (record["kind"] == "node").then(|| serde_json::from_value(record["pose"].clone()).unwrap())
    };
    graph.lines().filter_map(pose).collect()
}

fn assert_same_poses(first: &str, second: &str) {
    assert_poses_within(&poses(first), &poses(second), 1e-7);
}

fn assert_poses_within(first: &[Vec<f64>], second: &[Vec<f64>], tolerance: f64) {
    assert_eq!(first.len(), second.len());
    for (a, b) in first.iter().flatten().zip(second.iter().flatten()) {
        assert!((a - b).abs() < tolerance, "{a} {b}");
    }
}

/// The poses of a batch solution of these records.
fn batch(lines: &[String]) -> Vec<Vec<f64>> {
    let graph = PoseGraph::read("lines", lines.join("\n").as_bytes()).unwrap();
    let edges = posecut_optimize::pose_graph::edges::<SE2, 3>(&graph).unwrap().edges;
    let problem = Problem::new(vec![SE2::identity(); graph.nodes.len()], edges).unwrap();
    optimize(&problem, &Options::default()).poses.iter().map(SE2::components).collect()
}

pub(crate) fn temporary(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("posecut-{}-{name}", std::process::id()))
}

#[test]
fn a_stream_ends_where_a_batch_solution_of_what_is_left_does() {
    let graph = follow(&square(), &[]);
    let without: Vec<String> =
        square().into_iter().filter(|line| !line.contains("retract") && !line.contains("[9,9,0]")).collect();
    assert_poses_within(&poses(&graph), &batch(&without), 1e-7);
    let false_edge = graph.lines().find(|line| line.contains(r#""id":6"#)).unwrap();
    assert!(false_edge.contains(r#""rejected_by":"retract""#), "{false_edge}");
    assert!(!graph.contains(r#""kind":"retract""#), "what was done stands on the edge");
    // The result can be read again, as a file in canonical form.
    let again: Vec<String> = graph.lines().map(str::to_owned).collect();
    assert_same_poses(&graph, &follow(&again, &[]));
}

#[test]
fn edges_can_be_replaced_and_readmitted() {
    let mut replaced = square();
    replaced[9] = r#"{"kind":"landmark","id":8,"from":0,"to":2,"retract":6}"#.to_owned();
    assert_same_poses(&follow(&square(), &[]), &follow(&replaced, &[]));
    replaced[9] = edge("landmark", 8, 0, 2, "[1,1,3.14]").replace('}', r#","retract":6}"#);
    let graph = follow(&replaced, &[]);
    assert!(graph.lines().any(|line| line.contains(r#""id":8"#) && !line.contains("rejected_by")));
    let mut returned = square();
    returned.push(r#"{"kind":"readmit","edge":6}"#.to_owned());
    let kept: Vec<String> = square().into_iter().filter(|line| !line.contains("retract")).collect();
    let returned = follow(&returned, &[]);
    // With the false edge the minimum costs 9851, and undamped steps do not converge there. The descent ends where a step promises less
    // than 1e-10 of the cost, which determines a pose only up to sqrt(9851 * 1e-10 / 100) = 1e-4.
    let tolerance = 1e-4;
    assert_poses_within(&poses(&returned), &poses(&follow(&kept, &[])), tolerance);
    assert!(!returned.contains("rejected_by"));
    // An edge that arrived rejected is not used, and may be re-admitted.
    let mut rejected = square();
    rejected[9] = String::new();
    rejected[6] = rejected[6].replace('}', r#","rejected_by":"pcm"}"#);
    assert_same_poses(&follow(&square(), &[]), &follow(&rejected, &[]));
    rejected.push(r#"{"kind":"readmit","edge":6}"#.to_owned());
    assert_poses_within(&poses(&returned), &poses(&follow(&rejected, &[])), tolerance);
}

#[test]
fn estimates_on_the_way_and_figures_of_every_step_are_written() {
    let (estimates, statistics) = (temporary("estimates.jsonl"), temporary("statistics.json"));
    let files = ["--estimates", estimates.to_str().unwrap(), "--stats", statistics.to_str().unwrap()];
    let arguments: Vec<&str> = ["--every", "3"].into_iter().chain(files).collect();
    let graph = follow(&square(), &arguments);
    let lines = std::fs::read_to_string(&estimates).unwrap();
    let figures: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&statistics).unwrap()).unwrap();
    std::fs::remove_file(&estimates).unwrap();
    std::fs::remove_file(&statistics).unwrap();
    let lines: Vec<serde_json::Value> =
        lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let steps: Vec<_> = lines.iter().map(|line| (line["step"].as_u64(), line["node"].as_u64())).collect();
    assert_eq!(steps, [(Some(3), Some(2)), (Some(4), Some(3))]);
    assert!(lines[0]["cost"].as_f64().unwrap() > 100.0, "the false edge is in use: {}", lines[0]);
    assert!(lines[1]["cost"].as_f64().unwrap() < 1.0, "it was taken back: {}", lines[1]);
    assert_eq!(lines[1]["poses"].as_array().unwrap().len(), 4);
    assert_eq!(figures["steps"].as_array().unwrap().len(), 4);
    for name in ["relinearised", "eliminated", "solved", "seconds", "node"] {
        assert!(figures["steps"][2][name].is_number(), "{name}: {figures}");
    }
    assert_eq!((figures["retracted"].as_u64(), figures["edges"].as_u64()), (Some(1), Some(4)));
    assert_eq!(graph, follow(&square(), &[]), "looking changes nothing");
}

#[test]
fn a_removal_that_splits_the_graph_is_said() {
    let mut lines = square();
    lines[10] = r#"{"kind":"retract","edge":1}"#.to_owned();
    let output = run(&lines, &[]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("node 2 is fixed from now on"), "{said}");
}

#[test]
fn bad_input_is_refused_by_line() {
    let with = |place: usize, line: &str| {
        let mut lines = square();
        lines[place] = line.to_owned();
        refuse(&lines, &[])
    };
    let said = with(9, r#"{"kind":"retract","edge":77}"#);
    assert!(said.contains("line 10") && said.contains("edge 77 is unknown"), "{said}");
    let mut twice = square();
    twice.push(twice[9].clone());
    let said = refuse(&twice, &[]);
    assert!(said.contains("line 12") && said.contains("edge 6 was retracted before"), "{said}");
    let said = with(7, &node(3, 29));
    assert!(said.contains("line 8") && said.contains("29 lies before 30"), "{said}");
    let said = with(6, &edge("landmark", 6, 0, 3, "[9,9,0]"));
    assert!(said.contains("line 7") && said.contains("there is no node 3 so far"), "{said}");
    let said = with(9, r#"{"kind":"retract","id":6}"#);
    assert!(said.contains("line 10") && said.contains("field \"edge\""), "{said}");
    let said = with(9, r#"{"kind":"readmit","edge":"six"}"#);
    assert!(said.contains("found \"six\"; give a whole number"), "{said}");
    let said = with(9, r#"{"kind":"readmit","edge":1}"#);
    assert!(said.contains("edge 1 is in use"), "{said}");
    let said = with(9, r#"{"kind":"landmark","id":8,"from":0,"to":2,"retract":"six"}"#);
    assert!(said.contains("field \"retract\""), "{said}");
    let said = with(7, &node(2, 40));
    assert!(said.contains("node 2") && said.contains("line 5 already has a node with this id"), "{said}");
    let said = with(8, &edge("odometry", 1, 2, 3, "[1,0,0]"));
    assert!(
        said.contains("odometry 1") && said.contains("line 6 already has an edge with this id"),
        "{said}"
    );
    let mut rejected = square();
    rejected[6] = rejected[6].replace('}', r#","rejected_by":"pcm"}"#);
    let said = refuse(&rejected, &[]);
    assert!(said.contains("rejected by pcm and was never used"), "{said}");
}

#[test]
fn options_that_make_no_sense_are_refused() {
    assert!(refuse(&square(), &["--gnc"]).contains("--gnc"));
    assert!(refuse(&square(), &["--relinearise-rotation=-1"]).contains("must be zero or a positive number"));
    assert!(refuse(&square(), &["--every", "0", "--estimates", "x"]).contains("--every is 0"));
}

//! Re-admission by the innovation, through the library, and the inputs that it rejects.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::process::Command;

use posecut_graph::PoseGraph;
use posecut_readmit::{Readmission, readmit};

const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;

fn graph(lines: &[&str]) -> PoseGraph {
    PoseGraph::read("test", format!("{HEADER}\n{}\n", lines.join("\n")).as_bytes()).unwrap()
}

fn nodes(count: usize) -> Vec<String> {
    (0..count).map(|id| format!(r#"{{"kind":"node","id":{id},"pose":[{id},0,0]}}"#)).collect()
}

/// sigma^2 = 0.01 m^2 and 0.0025 rad^2.
fn edge(id: u64, from: u64, to: u64) -> String {
    format!(
        r#"{{"kind":"landmark","id":{id},"from":{from},"to":{to},"measurement":[{},0,0],"information":[100,0,0,100,0,400]}}"#,
        to as i64 - from as i64
    )
}

fn with(mut lines: Vec<String>, more: &[String]) -> PoseGraph {
    lines.extend_from_slice(more);
    graph(&lines.iter().map(String::as_str).collect::<Vec<_>>())
}

const READMISSION: Readmission =
    Readmission { admit: 0.99, drop: 0.9999, scale: Some(1.0), apply_scale: false, cost: 3.0 };

fn predicted(edge: &str, terms: &str) -> String {
    edge.replace('}', &format!(r#","predicted_covariance":{terms}}}"#))
}

#[test]
fn readmission_admits_drops_and_keeps_by_the_innovation() {
    // The estimate has node n at n metres.
    let near = predicted(&edge(1, 0, 2), "[0.005,0,0,0.005,0,0.001]").replace("[2,0,0]", "[2.1,0,0]");
    let wrong = predicted(&edge(2, 0, 3), "[0.005,0,0,0.005,0,0.001]").replace("[3,0,0]", "[5,0,0]");
    let rejected = |line: &str, stage: &str| line.replace('}', &format!(r#","rejected_by":"{stage}"}}"#));
    let lone = predicted(&edge(3, 3, 4), "[0.01,0,0,0.01,0,0.0025]");
    let unpredicted = predicted(&edge(4, 1, 4), "null");
    let cases = [
        // (line, rejected before, rejected after)
        (rejected(&near, "pcm"), None),
        (rejected(&wrong, "pcm"), Some("pcm")),
        (near.clone(), None),
        (wrong.clone(), Some("pcm")),
        (rejected(&near, "multicut"), Some("multicut")),
        (lone, None),
        // Between two components of the map nothing is predicted, so the edge keeps its state.
        (rejected(&unpredicted, "pcm"), Some("pcm")),
        (unpredicted.clone(), None),
    ];
    for (line, expected) in cases {
        let mut graph = with(nodes(5), std::slice::from_ref(&line));
        let result = readmit(&mut graph, &READMISSION).unwrap();
        assert_eq!(graph.edges[0].rejected_by.as_deref(), expected, "{line}");
        assert_eq!(result.tested + result.rejected_by_others, 1);
    }
}

/// Positions along 40 m; `count` edges in use that are off by `off` metres, and one rejected edge off by `rejected` metres.
fn used_and_rejected(count: u64, off: f64, rejected: f64, variance: f64) -> PoseGraph {
    let terms = format!("[{variance},0,0,{variance},0,{variance}]");
    let mut lines = Vec::new();
    for to in 1..=count {
        let line =
            edge(100 + to, 0, to).replace(&format!("[{to},0,0]"), &format!("[{},0,0]", to as f64 + off));
        lines.push(predicted(&line, "[1e-6,0,0,1e-6,0,1e-6]"));
    }
    let last = count + 1;
    let line =
        edge(999, 0, last).replace(&format!("[{last},0,0]"), &format!("[{},0,0]", last as f64 + rejected));
    lines.push(predicted(&line, &terms).replace('}', r#","rejected_by":"pcm"}"#));
    with(nodes(count as usize + 2), &lines)
}

#[test]
fn false_edges_in_use_do_not_raise_the_scale_without_bound() {
    // Every edge in use is off by 3 m at 0.1 m: the estimate would be 144.
    let mut graph = used_and_rejected(38, 3.0, 3.0, 1e-6);
    let result = readmit(&mut graph, &Readmission { scale: None, ..READMISSION }).unwrap();
    assert!(result.unbounded_scale.is_some_and(|scale| scale > 100.0), "{result:?}");
    assert_eq!((result.scale, result.readmitted), (9.0, 0));
    assert!(graph.edges.last().unwrap().rejected_by.is_some());
}

#[test]
fn an_edge_that_agrees_by_chance_is_not_readmitted() {
    // The map determines the position only to 30 m: among 39 edges along 40 m, agreement proves nothing.
    let mut graph = used_and_rejected(38, 0.05, 20.0, 900.0);
    let result = readmit(&mut graph, &READMISSION).unwrap();
    assert_eq!((result.readmitted, result.by_chance), (0, 1), "{result:?}");
    // With the position known to a few centimetres, the same agreement is evidence.
    let mut graph = used_and_rejected(38, 0.05, 0.05, 0.001);
    let result = readmit(&mut graph, &READMISSION).unwrap();
    assert_eq!((result.readmitted, result.by_chance), (1, 0), "{result:?}");
}

#[test]
fn the_innovation_of_an_edge_in_use_leaves_the_edge_out() {
    // One direction, scalar: measured 0.3 with variance 0.01, predicted by all others as 0 with variance 0.04. The
    // estimate with both is 0.24, of variance 0.008; the innovation 0.3^2 / (0.01 + 0.04) = 1.8.
    let line = predicted(&edge(1, 0, 1), "[0.008,0,0,0.005,0,0.001]");
    let mut lines = nodes(2);
    lines[1] = r#"{"kind":"node","id":1,"pose":[0.24,0,0]}"#.to_owned();
    let mut graph = with(lines, &[line.replace("[1,0,0]", "[0.3,0,0]")]);
    readmit(&mut graph, &READMISSION).unwrap();
    let innovation = graph.edges[0].extra["pcm_innovation"].as_f64().unwrap();
    assert!((innovation - 1.8).abs() < 1e-4, "{innovation}");
}

#[test]
fn readmission_without_marginals_says_what_to_run() {
    for (line, words) in [
        (edge(4, 0, 1), "is missing"),
        (predicted(&edge(4, 0, 1), "[1,2]"), "does not fit"),
        (predicted(&edge(4, 0, 1), r#"["a"]"#), "is not a list of numbers"),
    ] {
        let error = readmit(&mut with(nodes(2), &[line]), &READMISSION).unwrap_err().to_string();
        assert!(
            error.contains("landmark 4") && error.contains(words) && error.contains("--marginals"),
            "{error}"
        );
    }
    let bare = vec![r#"{"kind":"node","id":0}"#.to_owned(), r#"{"kind":"node","id":1}"#.to_owned()];
    let line = predicted(&edge(4, 0, 1), "[1,0,0,1,0,1]");
    let error = readmit(&mut with(bare, &[line]), &READMISSION).unwrap_err().to_string();
    assert!(error.contains("node 0") && error.contains("no pose"), "{error}");
}

#[test]
fn two_scales_are_refused() {
    for value in ["1,2", "0", "inf", "nan", "automatic", ""] {
        let output = Command::new(env!("CARGO_BIN_EXE_posecut-readmit"))
            .args(["--scale", value, "none.jsonl"])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{value}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            said.contains("`auto` or a positive number") || said.contains("a value is required"),
            "{said}"
        );
        assert_eq!(said.contains("one scale"), value == "1,2", "{said}");
    }
}

#[test]
fn a_cost_that_means_nothing_is_refused_before_anything_is_read() {
    for value in ["0", "-1", "inf", "nan"] {
        let output = Command::new(env!("CARGO_BIN_EXE_posecut-readmit"))
            .args([&format!("--chance={value}"), "none.jsonl"])
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("--chance is") && said.contains("positive number"), "{said}");
    }
}

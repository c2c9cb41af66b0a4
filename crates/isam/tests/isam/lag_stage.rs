//! The program with a lag: what is marginalised, refused, rejected and reported.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use std::process::Output;

use crate::stage::{HEADER, edge, follow, node, poses, refuse, run, temporary};

/// A line of so many nodes, one a second, with a landmark edge from the last one to node `target`.
fn line(nodes: u64, target: u64) -> Vec<String> {
    let mut lines = vec![HEADER.to_owned(), node(0, 0)];
    for id in 1..nodes {
        lines.push(node(id, 1_000_000 * i64::try_from(id).unwrap()));
        lines.push(edge("odometry", id, id - 1, id, "[1,0,0.1]"));
        if id % 8 == 7 {
            lines.push(edge("landmark", 1000 + id, id - 4, id, "[3.9,0.6,0.4]"));
        }
    }
    lines.push(edge("landmark", 900, target, nodes - 1, "[2,0.2,0.2]"));
    lines
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn statistics(lines: &[String], arguments: &[&str]) -> serde_json::Value {
    let path = temporary(&format!("lag-{}.json", arguments.join("")));
    follow(lines, &[arguments, &["--stats", path.to_str().unwrap()]].concat());
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_lag_keeps_poses_in_the_output_and_counts_what_is_final() {
    let lines = line(60, 57);
    let (lagged, full) = (follow(&lines, &["--lag", "20"]), follow(&lines, &[]));
    assert_eq!(poses(&lagged).len(), 60);
    for (a, b) in poses(&lagged).iter().flatten().zip(poses(&full).iter().flatten()) {
        assert!((a - b).abs() < 0.05, "{a} {b}");
    }
    let figures = statistics(&lines, &["--lag", "20"]);
    // Blocks of two: the last one leaves nodes 40 to 59, and the gauge.
    let live: Vec<u64> = serde_json::from_value(figures["live_nodes"].clone()).unwrap();
    assert_eq!(live, [vec![0], (40..60).collect::<Vec<u64>>()].concat());
    assert_eq!((figures["marginalised"].as_u64(), figures["beyond_lag"].as_u64()), (Some(39), Some(0)));
    assert!(
        figures["absorbed_edges"].as_u64().unwrap() > 40 && figures["live_nodes_max"].as_u64().unwrap() <= 23
    );
    assert!(said(&run(&lines, &["--lag", "20"])).contains("39 poses marginalised"));
    let by_time = statistics(&lines, &["--lag-time", "20"]);
    let live: Vec<u64> = serde_json::from_value(by_time["live_nodes"].clone()).unwrap();
    assert!(live.len() <= 24 && live.len() > 20 && live[1] == 60 - (live.len() as u64 - 1), "{live:?}");
}

#[test]
fn an_edge_to_a_marginalised_node_is_refused_by_name_or_rejected() {
    let lines = line(60, 7);
    let last = lines.len();
    let error = refuse(&lines, &["--lag", "20"]);
    let expected = format!(
        "line {last}: landmark 900: node 7 was marginalised and takes no more edges; increase the lag"
    );
    assert!(error.contains(&expected), "{error}");
    let rejecting = ["--lag", "20", "--beyond-lag", "reject"];
    let graph = follow(&lines, &rejecting);
    let late = graph.lines().find(|line| line.contains(r#""id":900,"#)).unwrap();
    assert!(late.contains(r#""rejected_by":"lag""#), "{late}");
    assert!(said(&run(&lines, &rejecting)).contains("1 edge beyond the lag rejected"));
    assert_eq!(statistics(&lines, &rejecting)["beyond_lag"].as_u64(), Some(1));
    // Node 7 ends a landmark edge, and is a multiple of 7.
    for keep in [["--keep-landmark-poses"].as_slice(), &["--keep-every", "7"]] {
        assert!(follow(&lines, &[&["--lag", "20"], keep].concat()).contains("900"), "{keep:?}");
    }
    // It stays rejected when it is to be readmitted.
    let mut readmitted = lines;
    readmitted.push(r#"{"kind":"readmit","edge":900}"#.to_owned());
    let graph = follow(&readmitted, &rejecting);
    assert!(graph.contains(r#""rejected_by":"lag""#));
}

#[test]
fn a_retraction_into_the_past_is_refused_by_name() {
    let mut lines = line(60, 57);
    lines.push(r#"{"kind":"retract","edge":1007}"#.to_owned());
    for arguments in [["--lag", "20", "--beyond-lag", "refuse"], ["--lag", "20", "--beyond-lag", "reject"]] {
        let error = refuse(&lines, &arguments);
        let expected = format!(
            "line {}: retract 1007: landmark 1007 from node 3 to node 7 is part of the marginalised past and cannot be retracted; increase the lag",
            lines.len()
        );
        assert!(error.contains(&expected), "{error}");
    }
    follow(&lines, &["--lag", "100"]);
}

#[test]
fn options_of_a_lag_that_make_no_sense_are_refused() {
    let lines = line(10, 3);
    assert!(refuse(&lines, &["--lag", "0"]).contains("number of poses in the lag is zero"));
    assert!(refuse(&lines, &["--lag-time=-1"]).contains("positive number of seconds"));
    assert!(refuse(&lines, &["--lag", "5", "--lag-time", "5"]).contains("cannot be used with"));
    assert!(refuse(&lines, &["--keep-every", "5"]).contains("no effect without a lag"));
    assert!(refuse(&lines, &["--keep-landmark-poses"]).contains("no effect without a lag"));
    assert!(refuse(&lines, &["--beyond-lag", "reject"]).contains("no effect without a lag"));
    let mut timeless = lines;
    timeless[1] = r#"{"kind":"node","id":0,"pose":[0,0,0]}"#.to_owned();
    assert!(refuse(&timeless, &["--lag-time", "5"]).contains("node 0 has no field \"utime\""));
}

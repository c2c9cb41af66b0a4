//! The program on a graph in canonical form.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use std::process::Output;

use crate::stage::run;

/// A square of four steps, with a true closing edge (5) and a false diagonal edge (6), both landmark edges.
const GRAPH: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0,"pose":[0,0,0]}
{"kind":"node","id":1,"pose":[1,0,1.5]}
{"kind":"node","id":2,"pose":[1,1,3]}
{"kind":"node","id":3,"pose":[0,1,-1.5]}
{"kind":"odometry","id":0,"from":0,"to":1,"measurement":[1,0,1.57],"information":[100,0,0,100,0,400]}
{"kind":"odometry","id":1,"from":1,"to":2,"measurement":[1,0,1.57],"information":[100,0,0,100,0,400]}
{"kind":"odometry","id":2,"from":2,"to":3,"measurement":[1,0,1.57],"information":[100,0,0,100,0,400]}
{"kind":"landmark","id":5,"from":3,"to":0,"measurement":[1,0,1.57],"information":[100,0,0,100,0,400]}
{"kind":"landmark","id":6,"from":0,"to":2,"measurement":[9,9,0],"information":[100,0,0,100,0,400]}
"#;

fn run_on(arguments: &[&str], graph: &str) -> Output {
    run(&graph.lines().map(str::to_owned).collect::<Vec<_>>(), arguments)
}

#[test]
fn an_infinite_cost_was_called_converged() {
    let infinite = GRAPH.replace(
        "[9,9,0],\"information\":[100,0,0,100,0,400]",
        "[1e160,9,0],\"information\":[1e10,0,0,100,0,400]",
    );
    assert_ne!(infinite, GRAPH);
    for arguments in [&[][..], &["--unfinished"]] {
        let output = run_on(arguments, &infinite);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{arguments:?}: {error}");
        assert!(
            error.contains("the cost of the solution is not finite: landmark 6"),
            "{arguments:?}: {error}"
        );
        assert!(!error.contains("NaN") && error.lines().count() == 1, "{arguments:?}: {error}");
    }
}

#[test]
fn small_costs_were_printed_as_zero() {
    let weak = GRAPH.replace("[100,0,0,100,0,400]", "[1e-10,0,0,1e-10,0,4e-10]");
    let error = String::from_utf8(run_on(&[], &weak).stderr).unwrap();
    let line = error.lines().find(|line| line.contains("isam: cost ")).unwrap();
    assert!(line.contains("e-") && line.contains("4 steps, 1 component"), "{error}");
}

#[test]
fn names_of_sessions_change_no_pose() {
    let poses = |name: &str| {
        let record = |line: &str| {
            line.replace("{\"kind\":\"node\",", &format!("{{\"kind\":\"node\",\"session\":\"{name}\","))
        };
        let output = run_on(&[], &GRAPH.lines().map(|line| record(line) + "\n").collect::<String>());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap().replace(&format!("\"session\":\"{name}\""), "");
        text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(poses("a"), poses("zürich"));
}

#[test]
fn fixed_nodes_stay_where_they_are() {
    let fixed = GRAPH
        .replace("\"id\":1,\"pose\":[1,0,1.5]", "\"id\":1,\"fixed\":true,\"pose\":[1,0,1.5]")
        .replace("\"id\":3,\"pose\":[0,1,-1.5]", "\"id\":3,\"fixed\":true,\"pose\":[0,1,-1.5]");
    let graph = String::from_utf8(run_on(&[], &fixed).stdout).unwrap();
    for (id, pose) in [(1, "[1,0,1.5]"), (3, "[0,1,-1.5]")] {
        let line = format!("{{\"kind\":\"node\",\"id\":{id},\"pose\":{pose},\"fixed\":true}}");
        assert!(graph.contains(&line), "{graph}");
    }
    // A fixed node replaces the gauge: the first node has moved.
    assert!(!graph.contains("{\"kind\":\"node\",\"id\":0,\"pose\":[0,0,0]"), "{graph}");
    for (mark, words) in [
        ("\"fixed\":\"yes\",\"pose\":[1,0,1.5]", "expected true or false, found \"yes\""),
        ("\"fixed\":true", "is fixed but has no pose; give it one"),
    ] {
        let bad = GRAPH.replace("\"id\":1,\"pose\":[1,0,1.5]", &format!("\"id\":1,{mark}"));
        let output = run_on(&[], &bad);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(
            output.status.code() == Some(2) && error.contains(words) && error.contains("node 1"),
            "{error}"
        );
    }
}

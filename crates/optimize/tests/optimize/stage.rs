//! The stage as a process: the effect of its options on the graph.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use std::io::Write as _;
use std::process::{Command, Output, Stdio};

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

fn run(arguments: &[&str]) -> Output {
    run_on(arguments, GRAPH)
}

fn run_on(arguments: &[&str], graph: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_posecut-optimize"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let _ = child.stdin.take().unwrap().write_all(graph.as_bytes());
    child.wait_with_output().unwrap()
}

/// Standard output of a run that must succeed.
fn succeed(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a run that must fail.
fn fail(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// The number in a field of the record with this kind and id, if it has the field.
fn field(graph: &str, kind: &str, id: u64, name: &str) -> Option<f64> {
    let start = format!("{{\"kind\":\"{kind}\",\"id\":{id},");
    let line = graph.lines().find(|line| line.starts_with(&start)).unwrap();
    let rest = line.split_once(&format!("\"{name}\":"))?.1;
    let end = rest.find([',', '}']).unwrap();
    Some(rest[..end].parse().unwrap())
}

#[test]
fn weights_stand_on_the_edges_under_a_kernel_and_nowhere_else() {
    let plain = succeed(&[]);
    assert!(!plain.contains("\"weight\""), "{plain}");
    for arguments in [["--kernel-landmark", "dcs"], ["--kernel-landmark", "geman-mcclure:2"], ["--gnc", "-q"]]
    {
        let graph = succeed(&arguments);
        assert!(field(&graph, "landmark", 5, "weight").unwrap() > 0.9, "{arguments:?}: {graph}");
        assert!(field(&graph, "landmark", 6, "weight").unwrap() < 0.01, "{arguments:?}: {graph}");
        assert_eq!(field(&graph, "odometry", 0, "weight"), None);
    }
    let graph = succeed(&["--kernel-odometry", "huber"]);
    assert!(
        field(&graph, "odometry", 0, "weight").is_some() && field(&graph, "landmark", 5, "weight").is_none()
    );
}

#[test]
fn kernels_that_make_no_sense_are_refused() {
    assert!(fail(&["--kernel-landmark", "tukey"]).contains("'tukey' is not a robust kernel"));
    assert!(fail(&["--kernel-odometry", "huber:-1"]).contains("'-1' is not a width"));
    assert!(fail(&["--gnc", "--gnc-width=-2"]).contains("positive number of standard deviations"));
    assert!(fail(&["--gnc", "--kernel-landmark", "dcs"]).contains("cannot be used with"));
}

#[test]
fn the_cost_of_gnc_was_taken_for_the_input_file() {
    for arguments in [&["--gnc", "geman-mcclure", "graph.jsonl"][..], &["-q", "--gnc", "tls"]] {
        let error = fail(arguments);
        let cost = arguments.iter().find(|word| ["geman-mcclure", "tls"].contains(word)).unwrap();
        assert!(error.contains(&format!("write --gnc={cost} ")), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
    // Both documented uses, with a file after them.
    let folder = std::env::temp_dir().join(format!("posecut-gnc-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("geman-mcclure");
    std::fs::write(&file, GRAPH).unwrap();
    for option in ["--gnc", "--gnc=geman-mcclure", "--gnc=truncated-least-squares", "--gnc=tls"] {
        let graph = succeed(&[option, file.to_str().unwrap()]);
        assert!(field(&graph, "landmark", 6, "weight").unwrap() < 0.01, "{option}: {graph}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(succeed(&["--help"]).contains("--gnc[=<COST>]"));
}

#[test]
fn an_infinite_cost_was_called_converged() {
    let infinite = GRAPH.replace(
        "[9,9,0],\"information\":[100,0,0,100,0,400]",
        "[1e160,9,0],\"information\":[1e10,0,0,100,0,400]",
    );
    assert_ne!(infinite, GRAPH);
    for arguments in [&[][..], &["--method", "dogleg"]] {
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
    let line = error.lines().find(|line| line.contains("optimize: cost ")).unwrap();
    assert!(line.contains("e-") && line.contains(" iterations, 1 component"), "{error}");
}

#[test]
fn names_of_sessions_change_no_pose() {
    let named = |name: &str| {
        let record = |line: &str| {
            line.replace("{\"kind\":\"node\",", &format!("{{\"kind\":\"node\",\"session\":\"{name}\","))
        };
        GRAPH.lines().map(|line| record(line) + "\n").collect::<String>()
    };
    let poses = |arguments: &[&str], name: &str| {
        let output = run_on(arguments, &named(name));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap().replace(&format!("\"session\":\"{name}\""), "");
        text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    for arguments in [&[][..], &["--method", "dogleg"], &["--gnc"]] {
        assert_eq!(poses(arguments, "a"), poses(arguments, "zürich"), "{arguments:?}");
    }
}

#[test]
fn certificates_stand_in_the_statistics_and_exclude_kernels() {
    let file = std::env::temp_dir().join(format!("posecut-certificate-{}.json", std::process::id()));
    let poses = succeed(&["--certify", "--stats", file.to_str().unwrap()]);
    let statistics = std::fs::read_to_string(&file).unwrap();
    std::fs::remove_file(&file).unwrap();
    let names = [
        "certificate",
        "certificate_eigenvalue",
        "certificate_tolerance",
        "chordal_cost",
        "chordal_lower_bound",
    ];
    for name in names {
        assert!(statistics.contains(&format!("\"{name}\": ")), "{name}: {statistics}");
    }
    let without_provenance = |text: &str| text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(without_provenance(&poses), without_provenance(&succeed(&[])), "certifying moves no pose");
    assert!(fail(&["--certify", "--gnc"]).contains("cannot be used with"));
}

#[test]
fn edges_of_low_weight_are_rejected_on_request_alone() {
    for arguments in
        [&["--gnc", "--reject-below", "0.5"][..], &["--kernel-landmark", "dcs", "--reject-below", "0.5"]]
    {
        let graph = succeed(arguments);
        let rejected: Vec<&str> = graph.lines().filter(|line| line.contains("\"rejected_by\"")).collect();
        assert_eq!(rejected.len(), 1, "{arguments:?}: {graph}");
        assert!(
            rejected[0].contains("\"id\":6") && rejected[0].contains("\"rejected_by\":\"optimize\""),
            "{rejected:?}"
        );
    }
    assert!(!succeed(&["--gnc"]).contains("\"rejected_by\""));
    assert!(fail(&["--reject-below", "0.5"]).contains("--gnc or --kernel-landmark"));
    assert!(fail(&["--gnc", "--reject-below", "1.5"]).contains("--reject-below is 1.5"));
}

#[test]
fn marginals_stand_on_landmark_edges_and_nodes() {
    let list = |graph: &str, kind: &str, id: u64, name: &str| -> Option<Vec<f64>> {
        let start = format!("{{\"kind\":\"{kind}\",\"id\":{id},");
        let line = graph.lines().find(|line| line.starts_with(&start)).unwrap();
        let rest = line.split_once(&format!("\"{name}\":["))?.1;
        Some(rest.split_once(']').unwrap().0.split(',').map(|number| number.parse().unwrap()).collect())
    };
    let rejected =
        GRAPH.replace("\"measurement\":[9,9,0]", "\"rejected_by\":\"pcm\",\"measurement\":[9,9,0]");
    let run = |arguments: &[&str]| {
        let output = run_on(arguments, &rejected);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let graph = run(&["--marginals", "landmark"]);
    // A rejected edge has a covariance too, but does not constrain: the square's diagonal is less certain than its side.
    let (closing, diagonal) = (
        list(&graph, "landmark", 5, "predicted_covariance").unwrap(),
        list(&graph, "landmark", 6, "predicted_covariance").unwrap(),
    );
    assert_eq!((closing.len(), diagonal.len()), (6, 6));
    // A loop of four equal edges: the angle of one step alone has the variance 1 / 400. The three other edges measure the
    // same, which leaves 3/4 of it, and positions along the loop reduce it further.
    assert!(closing[5] > 0.0 && closing[5] < 0.75 / 400.0, "{closing:?}");
    assert!(diagonal[5] > closing[5] && diagonal[0] > closing[0], "{diagonal:?} {closing:?}");
    assert_eq!(list(&graph, "odometry", 0, "predicted_covariance"), None);
    assert_eq!(list(&graph, "node", 1, "covariance"), None);
    let graph = run(&["--marginals", "poses"]);
    assert_eq!(list(&graph, "node", 0, "covariance").unwrap(), [0.0; 6]);
    let opposite = list(&graph, "node", 2, "covariance").unwrap();
    assert!(opposite.iter().zip(&diagonal).all(|(a, b)| (a - b).abs() < 1e-12), "{opposite:?} {diagonal:?}");
    assert_eq!(list(&graph, "landmark", 5, "predicted_covariance"), None);
    let both = run(&["--marginals", "all"]);
    assert!(both.contains("\"covariance\"") && both.contains("\"predicted_covariance\""));
}

#[test]
fn an_edge_between_two_parts_has_a_marginal_of_null() {
    // Without odometry 0 and 1, node 1 is alone.
    let lines = GRAPH
        .lines()
        .filter(|line| !line.contains("\"odometry\",\"id\":0") && !line.contains("\"odometry\",\"id\":1"));
    let edge = "{\"kind\":\"landmark\",\"id\":7,\"from\":1,\"to\":3,\"rejected_by\":\"pcm\",\"measurement\":[1,1,0],\"information\":[100,0,0,100,0,400]}";
    let apart = lines.chain([edge]).collect::<Vec<_>>().join("\n");
    let output = run_on(&["--marginals", "landmark"], &apart);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let graph = String::from_utf8(output.stdout).unwrap();
    let of =
        |id: &str| graph.lines().find(|line| line.contains(&format!("\"landmark\",\"id\":{id},"))).unwrap();
    assert!(of("7").contains("\"predicted_covariance\":null"), "{}", of("7"));
    assert!(of("5").contains("\"predicted_covariance\":["), "{}", of("5"));
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
    let certified = run_on(&["--certify"], &fixed);
    assert!(
        String::from_utf8(certified.stderr).unwrap().contains("does not apply to 1 component"),
        "several fixed nodes are no graph of edges alone"
    );
}

/// The incremental solver was a mode of this program before.
#[test]
fn options_of_the_incremental_solver_name_its_program() {
    for arguments in [
        &["--solver", "isam2"][..],
        &["--solver=isam2"],
        &["--solver", "batch"],
        &["--unfinished"],
        &["--propagate=1e-3"],
        &["--every", "3", "--estimates", "x"],
    ] {
        let error = fail(arguments);
        assert!(error.contains("posecut-isam") && error.contains("leave --"), "{arguments:?}: {error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

/// To all other stages, records of posecut-isam are of unknown kind.
#[test]
fn retract_records_pass_through() {
    let record = r#"{"kind":"retract","edge":6,"why":"the front end thought better of it"}"#;
    let output = run_on(&[], &format!("{GRAPH}{record}\n"));
    assert!(String::from_utf8(output.stdout).unwrap().ends_with(&format!("{record}\n")));
}

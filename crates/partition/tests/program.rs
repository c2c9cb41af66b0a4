//! The program from end to end: plain instances and their certificates.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A separate folder for each test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn run(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_posecut-partition"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap()
}

fn succeed(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn fails(folder: &Path, arguments: &str, status: i32) -> String {
    let output = run(folder, arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(status), "{arguments}: {said}");
    said + &String::from_utf8(output.stdout).unwrap()
}

/// Asserts that the statistics contain `"key": value`.
fn holds(folder: &Path, file: &str, key: &str, value: &str) {
    let text = std::fs::read_to_string(folder.join(file)).unwrap();
    let line = format!("\"{key}\": {value}");
    assert!(text.lines().any(|found| found.trim().trim_end_matches(',') == line), "no {line} in {text}");
}

const TRIANGLE: &str = "MULTICUT\n0 1 2\n1 2 1\n0 2 -3\n";

#[test]
fn a_plain_instance_gives_one_label_a_line() {
    let folder = folder("plain");
    std::fs::write(folder.join("t.mc"), TRIANGLE).unwrap();
    for solver in ["exact", "klj", "gaec"] {
        let arguments = format!("solve t.mc --solver {solver} --stats s.json -o labels --threads 1");
        succeed(&folder, &arguments);
        assert_eq!(std::fs::read_to_string(folder.join("labels")).unwrap(), "0\n0\n1\n");
        for (key, value) in [
            ("objective", "-2.0"),
            ("lower_bound", "-2.0"),
            ("optimal", "true"),
            ("gap", "0.0"),
            ("nodes", "3"),
        ] {
            holds(&folder, "s.json", key, value);
        }
        let text = std::fs::read_to_string(folder.join("s.json")).unwrap();
        assert!(["seconds", "kernel_nodes", "kernel_edges"].iter().all(|key| text.contains(key)), "{text}");
    }
    // A limit that is reached at once leaves the simplest multicut: no edge inside a conflicted component is cut.
    assert_eq!(succeed(&folder, "solve t.mc --work-limit 0 --time-limit 0"), "0\n0\n0\n");
}

#[test]
fn odd_instances_are_defined() {
    let folder = folder("odd");
    let labels = |text: &str| {
        std::fs::write(folder.join("odd.mc"), text).unwrap();
        succeed(&folder, "solve odd.mc --quiet")
    };
    assert_eq!(labels("MULTICUT\n"), "", "no node");
    assert_eq!(labels("MULTICUT\n0 0 -5\n"), "0\n", "one node, one self-loop");
    assert_eq!(labels("MULTICUT\n0 1 2\n1 0 -3\n"), "0\n1\n", "parallel edges add");
    assert_eq!(labels("MULTICUT\n0 1 2\n1 0 -1\n"), "0\n0\n", "parallel edges add");
    assert_eq!(labels("MULTICUT\n0 1 0\n"), "0\n1\n", "nothing holds");
    assert_eq!(labels("MULTICUT\n2 3 1\n"), "0\n1\n2\n2\n", "nodes without edges");
}

#[test]
fn bad_instances_are_refused_with_file_and_line() {
    let folder = folder("bad");
    for (text, said) in [
        ("0 1 1\n", "bad.mc: line 1 "),
        ("", "bad.mc: line 1 "),
        ("MULTICUT\n0 1 1\n0 1\n", "bad.mc: line 3 "),
        ("MULTICUT\n0 1 nan\n", "bad.mc: line 2: edge 0 (0, 1) costs NaN"),
        ("MULTICUT\n0 1 inf\n", "costs inf"),
        ("MULTICUT\n0 1 1e308\n0 1 1e308\n", "add up to infinity"),
        ("MULTICUT\n0 99999999999999999999 1\n", "bad.mc: line 2: the graph has"),
        ("MULTICUT\n0 4294967295 1\n", "bad.mc: line 2: the graph has"),
    ] {
        std::fs::write(folder.join("bad.mc"), text).unwrap();
        let message = fails(&folder, "solve bad.mc -o labels --stats s.json --certificate c", 2);
        assert_eq!(message.matches(said).count(), 1, "{text:?}: {message}");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "{text:?} left files");
    }
    assert!(fails(&folder, "solve none.mc", 2).contains("none.mc: cannot be opened"));
    assert!(fails(&folder, "solve bad.mc --time-limit=-1", 2).contains("--time-limit is -1"));
    assert!(fails(&folder, "solve bad.mc -o x --certificate x", 2).contains("name two files"));
}

#[test]
fn certificates_are_written_and_checked() {
    let folder = folder("certificate");
    std::fs::write(folder.join("t.mc"), TRIANGLE).unwrap();
    std::fs::write(folder.join("other.mc"), TRIANGLE.replace("-3", "3")).unwrap();
    succeed(&folder, "solve t.mc -o labels --certificate t.proof");
    let said = succeed(&folder, "verify t.proof t.mc --stats v.json");
    assert!(said.contains("the labels cost -2, and no multicut costs less"), "{said}");
    holds(&folder, "v.json", "optimal", "true");
    holds(&folder, "v.json", "holds", "true");
    let text = std::fs::read_to_string(folder.join("t.proof")).unwrap();
    // For other costs, the same labels are not optimal.
    let other = run(&folder, "verify t.proof other.mc");
    let said = String::from_utf8(other.stdout).unwrap();
    assert!(!said.contains("no multicut costs less\n"), "{said}");
    // A part with a node that does not exist.
    let component = text.lines().nth(2).unwrap();
    std::fs::write(folder.join("spoiled"), text.replace(component, "component 0 1 9")).unwrap();
    assert!(fails(&folder, "verify spoiled t.mc", 1).contains("spoiled: proves nothing: line 3"));
    std::fs::write(folder.join("cut"), &text[..text.len() / 2]).unwrap();
    assert!(fails(&folder, "verify cut t.mc", 1).contains("proves nothing"));
    assert!(fails(&folder, "verify t.mc t.mc", 2).contains("t.mc: line 1 is not"));
    assert!(fails(&folder, "verify t.proof t.mc --costs count", 2).contains("for pose graphs"));
    assert!(fails(&folder, "verify none t.mc", 2).contains("none: cannot be opened"));
    assert!(fails(&folder, "verify t.proof none.mc", 2).contains("none.mc: cannot be opened"));
}

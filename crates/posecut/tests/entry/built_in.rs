//! Programs that are built into `posecut`.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

use crate::{PLACE, install, text};

/// A folder with nothing but `posecut`.
static LONELY: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    install(Path::new(env!("CARGO_BIN_EXE_posecut")), &folder.path().join("posecut"));
    folder
});

/// Runs the one file in its folder, with a PATH on which there is no program of posecut.
fn lonely(arguments: &[&str], input: &str) -> Output {
    use std::io::Write as _;
    let mut child = Command::new(LONELY.path().join("posecut"))
        .args(arguments)
        .env("PATH", "/nonexistent")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdin.take().unwrap().write_all(input.as_bytes()));
    child.wait_with_output().unwrap()
}

/// Two laps of 40 steps around a square as g2o, with closures between them, and two that are wrong.
fn laps() -> String {
    let mut graph = String::new();
    for node in 1..80 {
        let turn = if node % 10 == 0 { std::f64::consts::FRAC_PI_2 } else { 0.0 };
        writeln!(graph, "EDGE_SE2 {} {node} 1 0 {turn} 1000 0 0 1000 0 40000", node - 1).unwrap();
    }
    for node in 40..80 {
        writeln!(graph, "EDGE_SE2 {} {node} 0.01 0.01 0 1000 0 0 1000 0 10000", node - 40).unwrap();
    }
    graph + "EDGE_SE2 3 18 0 0 0 1000 0 0 1000 0 10000\nEDGE_SE2 25 70 0 0 0 1000 0 0 1000 0 10000\n"
}

/// A new program need not be built in: `posecut` finds it beside itself, and the release workflow asks for it.
#[test]
fn every_built_in_program_is_one_of_the_workspace() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let programs: BTreeSet<String> = std::fs::read_dir(crates)
        .unwrap()
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().join("src/main.rs").exists())
        .map(|entry| entry.file_name().into_string().unwrap())
        .filter(|name| name != "posecut" && name != "xtask")
        .collect();
    let built_in: BTreeSet<String> = posecut::built_in::names().into_iter().map(str::to_owned).collect();
    assert!(built_in.is_subset(&programs), "{built_in:?} {programs:?}");
    assert!(built_in.len() > 20, "{built_in:?}");
}

#[test]
fn one_file_lists_all_programs() {
    let help = text(&lonely(&["help"], "").stdout);
    for name in posecut::built_in::names() {
        assert!(help.contains(&format!("\n  {name} ")), "{name}: {help}");
    }
    assert!(!help.contains("Other programs"), "{help}");
    let versions = text(&lonely(&["version"], "").stdout);
    assert_eq!(versions.lines().count(), 1 + posecut::built_in::names().len(), "{versions}");
    assert!(!versions.contains("unknown"), "{versions}");
}

#[test]
fn a_built_in_program_gets_arguments_and_input_and_keeps_its_exit_status() {
    let graph = lonely(&["convert", "--to", "jsonl", "-"], &laps());
    assert_eq!(graph.status.code(), Some(0), "{}", text(&graph.stderr));
    let graph = text(&graph.stdout);
    let fine = lonely(&["inspect", "validate", "-"], &graph);
    assert_eq!(fine.status.code(), Some(0), "{}", text(&fine.stderr));
    // A check that fails has another exit status than an error.
    let broken = lonely(&["inspect", "validate", "-"], &graph.replace("\"to\":3,", "\"to\":999,"));
    assert_eq!(broken.status.code(), Some(1), "{}", text(&broken.stdout));
    let refused = lonely(&["pcm", "--chance", "many"], &graph);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).starts_with("posecut-pcm: error: "), "{}", text(&refused.stderr));
    let help = lonely(&["help", "verify"], "");
    assert!(text(&help.stdout).contains("Usage: posecut-verify"), "{}", text(&help.stdout));
}

#[test]
fn a_program_beside_comes_before_the_built_in_one_and_that_before_the_path() {
    let beside = PLACE.run(&["oracle", "x"]);
    assert_eq!((text(&beside.stdout).as_str(), beside.status.code()), ("x|input", Some(7)));
    let built_in = PLACE.run(&["islands", "--version"]);
    assert_eq!(text(&built_in.stdout), concat!("posecut-islands ", env!("CARGO_PKG_VERSION"), "\n"));
}

#[test]
fn one_file_cleans_a_graph_by_programs_that_are_built_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("map.g2o"), laps()).unwrap();
    let (map, out, page) = (path("map.g2o"), path("out.jsonl"), path("page.html"));
    let arguments = ["clean", "--method", "pcm+multicut", &map, "-o", &out, "--page", &page];
    let output = lonely(&arguments, "");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("rejected   2 (2 pcm)"), "{said}");
    let graph = std::fs::read_to_string(&out).unwrap();
    for stage in ["pcm", "multicut", "clean"] {
        assert!(graph.contains(&format!("\"stage\":\"{stage}\"")), "{stage}");
    }
    assert!(std::fs::read_to_string(&page).unwrap().contains("rejected by pcm"));
}

//! One table holds every program to the contract of inputs and outputs. A program that is missing from the
//! table fails.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::io::Read as _;
use std::process::{Command, Stdio};

use posecut_contract::{program, run, samples, succeed, workspace};

/// A program as the contract sees it.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    /// Arguments before the input; `{sample}` is replaced by a sample's path, `{posecut-NAME}` by a program's.
    pub(crate) arguments: &'static [&'static str],
    /// The sample that it reads, if one file.
    pub(crate) input: Option<&'static str>,
    /// Whether it takes that input from standard input too.
    pub(crate) pipe: bool,
    /// Whether it writes one file or standard output.
    writes_stream: bool,
}

pub(crate) const TABLE: &[Row] = &[
    Row {
        name: "conform",
        arguments: &["--", "{posecut-islands}"],
        input: None,
        pipe: false,
        writes_stream: true,
    },
    Row {
        name: "construct",
        arguments: &["--radius", "8"],
        input: Some("session.jsonl"),
        pipe: true,
        writes_stream: true,
    },
    Row {
        name: "convert",
        arguments: &["--to", "g2o"],
        input: Some("graph.jsonl"),
        pipe: true,
        writes_stream: true,
    },
    Row { name: "densest", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "evaluate", arguments: &[], input: Some("optimized.jsonl"), pipe: true, writes_stream: true },
    Row {
        name: "experiment",
        arguments: &["plan", "{paper.toml}", "--stages", "{stages.toml}"],
        input: None,
        pipe: false,
        writes_stream: true,
    },
    Row { name: "ingest", arguments: &["{2012-01-22}"], input: None, pipe: false, writes_stream: true },
    Row {
        name: "inspect",
        arguments: &["info"],
        input: Some("graph.jsonl"),
        pipe: true,
        writes_stream: true,
    },
    Row {
        name: "inspect",
        arguments: &["validate", "{graph.jsonl}"],
        input: None,
        pipe: false,
        writes_stream: true,
    },
    Row {
        name: "inspect",
        arguments: &["diff", "{graph.jsonl}", "{graph.jsonl}"],
        input: None,
        pipe: false,
        writes_stream: true,
    },
    Row {
        name: "inspect",
        arguments: &["filter", "--kind", "landmark"],
        input: Some("graph.jsonl"),
        pipe: true,
        writes_stream: true,
    },
    Row { name: "isam", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "islands", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "label", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "multicut", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "optimize", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "oracle", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "pcm", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "ransac", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row {
        name: "report",
        arguments: &["table", "{x.result.json}"],
        input: None,
        pipe: false,
        writes_stream: true,
    },
    Row { name: "simulate", arguments: &["--length", "100"], input: None, pipe: false, writes_stream: false },
    Row { name: "verify", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
    Row { name: "voting", arguments: &[], input: Some("graph.jsonl"), pipe: true, writes_stream: true },
];

impl Row {
    pub(crate) fn arguments(&self) -> Vec<String> {
        let sample =
            |argument: &&str| match argument.strip_prefix('{').and_then(|rest| rest.strip_suffix('}')) {
                Some(name) => match name.strip_prefix("posecut-") {
                    Some(name) => program(name).to_str().unwrap().to_owned(),
                    None => samples().path(name),
                },
                None => (*argument).to_owned(),
            };
        let input = self.input.map(|name| samples().path(name));
        self.arguments.iter().map(sample).chain(input).collect()
    }

    pub(crate) fn run(&self, more: &[&str]) -> std::process::Output {
        let arguments = self.arguments();
        let mut all: Vec<&str> = arguments.iter().map(String::as_str).collect();
        // What stands after `--` is somebody else's command.
        let end = all.iter().position(|&argument| argument == "--").unwrap_or(all.len());
        all.splice(end..end, more.iter().copied());
        run(self.name, &all, b"")
    }
}

pub(crate) fn streams() -> impl Iterator<Item = &'static Row> {
    TABLE.iter().filter(|row| row.writes_stream)
}

#[test]
fn the_table_has_every_program() {
    let crates = std::fs::read_dir(workspace().join("crates")).unwrap();
    let programs: BTreeSet<String> = crates
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.join("src/main.rs").is_file())
        .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    let table: BTreeSet<String> = TABLE.iter().map(|row| row.name.to_owned()).collect();
    assert_eq!(programs, table, "every program stands in the table of the contract");
}

#[test]
fn help_and_version_are_answers() {
    for row in TABLE {
        let help = String::from_utf8(succeed(row.name, &["--help"], b"")).unwrap();
        assert!(help.contains("Usage:") && help.contains("--output"), "{}: {help}", row.name);
        let version = String::from_utf8(succeed(row.name, &["--version"], b"")).unwrap();
        assert_eq!(version.trim(), format!("posecut-{} {}", row.name, env!("CARGO_PKG_VERSION")));
    }
}

#[test]
fn unknown_options_are_errors() {
    for row in TABLE {
        let output = run(row.name, &["--no-such-option"], b"");
        assert_eq!(output.status.code(), Some(2), "{}", row.name);
        assert!(output.stdout.is_empty(), "{}", row.name);
    }
}

#[test]
fn files_pipes_runs_and_threads_give_the_same_bytes() {
    for row in streams() {
        let first = row.run(&[]);
        assert!(first.status.success(), "{}: {}", row.name, String::from_utf8_lossy(&first.stderr));
        assert!(!first.stdout.is_empty(), "{}", row.name);
        for threads in ["1", "2"] {
            assert_eq!(
                first.stdout,
                row.run(&["--threads", threads]).stdout,
                "{} with {threads} threads",
                row.name
            );
        }
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("out");
        assert!(row.run(&["-o", file.to_str().unwrap()]).status.success());
        assert_eq!(
            first.stdout,
            std::fs::read(&file).unwrap(),
            "{}: a file holds what a pipe carries",
            row.name
        );
        if let (true, Some(input)) = (row.pipe, row.input) {
            let mut arguments = row.arguments.to_vec();
            if row.name == "convert" {
                arguments.extend(["--from", "jsonl"]);
            }
            let piped = succeed(row.name, &arguments, &samples().bytes(input));
            assert_eq!(first.stdout, piped, "{}: standard input is read like a file", row.name);
        }
    }
}

#[test]
fn compressed_input_is_read_and_compressed_output_written() {
    use std::io::Write as _;
    let folder = tempfile::tempdir().unwrap();
    for row in streams().filter(|row| row.pipe) {
        let plain = row.run(&[]).stdout;
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(&samples().bytes(row.input.unwrap())).unwrap();
        let mut arguments = row.arguments.to_vec();
        if row.name == "convert" {
            arguments.extend(["--from", "jsonl"]);
        }
        let file = folder.path().join(format!("{}.gz", row.name));
        arguments.extend(["-o", file.to_str().unwrap()]);
        succeed(row.name, &arguments, &encoder.finish().unwrap());
        let mut text = Vec::new();
        flate2::read::GzDecoder::new(std::fs::File::open(&file).unwrap()).read_to_end(&mut text).unwrap();
        assert_eq!(plain, text, "{}", row.name);
    }
}

#[test]
fn a_full_disk_is_an_error() {
    for row in streams() {
        let output = row.run(&["-o", "/dev/full"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{}: {said}", row.name);
        assert!(said.contains("/dev/full") && said.contains("No space left"), "{}: {said}", row.name);
    }
}

/// The system refuses to let a file grow, as a disk does that fills up in the middle.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_while_a_file_is_written_leaves_the_old_one() {
    // In blocks of 512 bytes.
    const LIMIT: usize = 1;
    let mut limited = 0;
    for row in streams().filter(|row| row.name != "conform") {
        if row.run(&[]).stdout.len() <= LIMIT * 512 {
            continue;
        }
        limited += 1;
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("out");
        std::fs::write(&file, "precious").unwrap();
        let script = format!("trap '' XFSZ; ulimit -f {LIMIT}; exec \"$@\"");
        let output = Command::new("sh")
            .args(["-c", &script, "sh"])
            .arg(program(row.name))
            .args(row.arguments())
            .arg("-o")
            .arg(&file)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{}: {said}", row.name);
        assert!(
            said.contains("nothing was left there") && said.contains("too large"),
            "{}: {said}",
            row.name
        );
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "precious", "{}", row.name);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{}: something was left", row.name);
    }
    assert!(limited > 5, "only {limited} programs write enough for the limit to matter");
}

/// The superuser may write anywhere but into the kernel's own folders.
#[cfg(target_os = "linux")]
#[test]
fn a_read_only_folder_is_an_error() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o555)).unwrap();
    let all_powerful = std::fs::write(folder.path().join("probe"), "").is_ok();
    let place = if all_powerful { std::path::Path::new("/proc/self") } else { folder.path() };
    let file = place.join("out.jsonl");
    for row in TABLE {
        let output = row.run(&["-o", file.to_str().unwrap()]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{}: {said}", row.name);
        assert!(said.contains("cannot be written, and nothing was left there"), "{}: {said}", row.name);
        assert!(!file.exists());
    }
    for row in streams() {
        let output = row.run(&["--stats", file.to_str().unwrap(), "-o", "/dev/null"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{}: {said}", row.name);
    }
}

#[test]
fn a_missing_folder_is_an_error_and_is_not_made() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("missing/out.jsonl");
    for row in streams() {
        let output = row.run(&["-o", file.to_str().unwrap()]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{}: {said}", row.name);
        assert!(said.contains("missing/out.jsonl"), "{}: {said}", row.name);
        assert!(!folder.path().join("missing").exists());
    }
}

#[test]
fn output_and_statistics_may_not_be_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("same.json");
    let file = file.to_str().unwrap();
    for row in streams() {
        let output = row.run(&["-o", file, "--stats", file]);
        assert_eq!(output.status.code(), Some(2), "{}", row.name);
        assert!(String::from_utf8_lossy(&output.stderr).contains("overwrite"), "{}", row.name);
        assert!(!std::path::Path::new(file).exists(), "{}", row.name);
    }
}

/// A file of the name `-` was made.
#[test]
fn statistics_do_not_go_to_standard_output() {
    for row in streams() {
        let output = row.run(&["--stats", "-"]);
        assert_eq!(output.status.code(), Some(2), "{}", row.name);
        assert!(String::from_utf8_lossy(&output.stderr).contains("name a file"), "{}", row.name);
    }
}

#[test]
fn a_closed_pipe_is_no_error() {
    for row in streams() {
        // The work is done all the same, and whoever asked for a summary gets it.
        let folder = tempfile::tempdir().unwrap();
        let stats = folder.path().join("stats.json");
        let mut child = Command::new(program(row.name))
            .args(["--stats", stats.to_str().unwrap()])
            .args(row.arguments())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {said}", row.name);
        assert!(!said.contains("error"), "{}: {said}", row.name);
        let stats: serde_json::Value = serde_json::from_slice(&std::fs::read(&stats).unwrap()).unwrap();
        assert_eq!(stats["stage"], row.name);
    }
}

#[test]
fn statistics_are_json_with_the_stages_name() {
    let folder = tempfile::tempdir().unwrap();
    let expected: &[(&str, &[&str])] = &[
        ("conform", &["passed", "failed", "advice", "skipped", "checks"]),
        ("construct", &["landmark_edges", "incorrect_edges"]),
        ("convert", &["nodes", "edges"]),
        ("densest", &["candidates", "density", "rejected"]),
        ("evaluate", &["rmse", "edges"]),
        ("experiment", &["tasks", "results"]),
        ("inspect", &["nodes", "sessions", "components", "provenance"]),
        ("ingest", &["keyframes", "path_length_m", "dropped_rows", "gaps"]),
        ("isam", &["cost", "converged", "components", "steps"]),
        ("islands", &["islands", "islands_kept", "rejected"]),
        ("multicut", &["objective", "lower_bound", "optimal", "landmarks", "cut_edges"]),
        ("optimize", &["chi_square_initial", "chi_square", "cost", "iterations", "converged", "components"]),
        ("oracle", &["rejected"]),
        ("pcm", &["candidates", "consistent_pairs", "clique_size", "clique_upper_bound", "optimal"]),
        ("ransac", &["candidates", "trials", "rejected"]),
        ("verify", &["candidates", "accepted", "undecided", "rejected", "calibration"]),
        ("voting", &["clusters", "clusters_kept", "optimisations", "rejected"]),
    ];
    for (name, keys) in expected {
        let row = TABLE.iter().find(|row| row.name == *name).unwrap();
        let file = folder.path().join(format!("{name}.json"));
        assert!(row.run(&["--stats", file.to_str().unwrap()]).status.success(), "{name}");
        let stats: serde_json::Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        assert_eq!(stats["stage"], *name);
        for key in *keys {
            assert!(!stats[*key].is_null(), "{name}: {key} is missing in {stats}");
        }
    }
}

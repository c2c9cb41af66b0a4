//! Tests that a program that is ended while it writes leaves the old file and no partial one.

#![cfg(unix)]

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use posecut_contract::{program, samples};

/// Programs from graph to graph, which write large files.
const COMMANDS: &[&[&str]] = &[
    &["oracle"],
    &["pcm"],
    &["ransac"],
    &["isam"],
    &["islands"],
    &["densest"],
    &["verify"],
    &["voting"],
    &["multicut"],
    &["optimize"],
    &["inspect", "filter"],
];

/// The number of attempts to catch a program while it writes.
const TRIES: usize = 5;

/// The sample with many records of an unknown kind, which every stage passes through. Computing takes no longer with them, but
/// compressing does.
fn heavy_graph(folder: &Path) -> String {
    let mut text = String::from_utf8(samples().bytes("graph.jsonl")).unwrap();
    let mut state = 1_u64;
    for _ in 0..50_000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let _ = writeln!(text, "{{\"kind\":\"ballast\",\"a\":{state},\"b\":{}}}", state.rotate_left(29));
    }
    let path = folder.join("heavy.jsonl");
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

fn temporary_files(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path());
    entries.filter(|path| path.file_name().unwrap().to_string_lossy().starts_with(".posecut-")).collect()
}

/// Whether something was written into a file or directory.
fn has_content(path: &Path) -> bool {
    match std::fs::read_dir(path) {
        Ok(mut entries) => entries.next().is_some(),
        Err(_) => std::fs::metadata(path).is_ok_and(|metadata| metadata.len() > 0),
    }
}

fn start(name: &str, arguments: &[&str]) -> Child {
    Command::new(program(name))
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Ends a program as soon as it writes. Returns whether the signal ended it.
fn end_while_writing(child: &mut Child, folder: &Path, signal: &str) -> bool {
    let limit = Instant::now() + Duration::from_mins(2);
    while child.try_wait().unwrap().is_none() && Instant::now() < limit {
        if temporary_files(folder).iter().any(|path| has_content(path)) {
            let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
            let status = child.wait().unwrap();
            return sent.success() && !status.success();
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    child.wait().unwrap();
    false
}

#[test]
fn a_stage_ended_while_it_writes_leaves_the_old_file() {
    let inputs = tempfile::tempdir().unwrap();
    let graph = heavy_graph(inputs.path());
    for command in COMMANDS {
        let name = command[0];
        for signal in ["-TERM", "-INT", "-KILL"] {
            let caught = (0..TRIES).any(|_| {
                let folder = tempfile::tempdir().unwrap();
                let (out, stats) = (folder.path().join("out.jsonl.gz"), folder.path().join("stats.json"));
                std::fs::write(&out, "precious").unwrap();
                let mut arguments = command[1..].to_vec();
                arguments.extend([&graph, "-o", out.to_str().unwrap(), "--stats", stats.to_str().unwrap()]);
                let caught = end_while_writing(&mut start(name, &arguments), folder.path(), signal);
                if caught {
                    assert_eq!(std::fs::read(&out).unwrap(), b"precious", "{name} {signal}");
                    assert!(!stats.exists(), "{name} {signal}: a summary of what did not happen");
                    // After KILL a program cannot clean up. The remaining file has a temporary name and is not the output.
                    let left = temporary_files(folder.path());
                    assert!(signal == "-KILL" || left.is_empty(), "{name} {signal} left {left:?}");
                }
                caught
            });
            assert!(
                caught,
                "{name} {signal}: it always ended before it was seen writing, so nothing was tested"
            );
        }
    }
}

#[test]
fn a_directory_ended_while_it_is_filled_does_not_appear() {
    for signal in ["-TERM", "-KILL"] {
        let caught = (0..TRIES).any(|_| {
            let folder = tempfile::tempdir().unwrap();
            let out = folder.path().join("2012-01-22");
            let arguments = ["--length", "3000", "--rate", "50", "-o", out.to_str().unwrap()];
            let caught = end_while_writing(&mut start("simulate", &arguments), folder.path(), signal);
            if caught {
                assert!(!out.exists(), "{signal}: half a session");
                let left = temporary_files(folder.path());
                assert!(signal == "-KILL" || left.is_empty(), "{signal} left {left:?}");
            }
            caught
        });
        assert!(caught, "{signal}: it always ended before it was seen writing, so nothing was tested");
    }
}

/// Regression: one interrupted simulation in eighteen left its temporary folder, because a file was made between the deletion
/// of the files and that of the folder.
#[test]
fn no_interrupted_simulation_leaves_its_folder() {
    let mut caught = 0;
    for round in 0..40 {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("2012-01-22");
        // Make small files in quick succession.
        let arguments = ["--length", "200", "--rate", "5", "-o", out.to_str().unwrap()];
        let signal = if round % 2 == 0 { "-TERM" } else { "-INT" };
        caught += usize::from(end_while_writing(&mut start("simulate", &arguments), folder.path(), signal));
        let left = temporary_files(folder.path());
        assert!(left.is_empty(), "round {round}, {signal} left {left:?}");
    }
    println!("{caught} of 40 were interrupted while they wrote");
}

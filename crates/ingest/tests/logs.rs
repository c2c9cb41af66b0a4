//! The program with CARMEN logs.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A log of four scans, 0.6 m apart.
fn log() -> String {
    let mut text = String::new();
    for scan in 0..4 {
        let x = 0.6 * f64::from(scan);
        text += &format!("FLASER 4 1.5 2.5 60.0 81.91 {x} 0 0 {x} 0 0 {scan}.5 nohost 0\n");
    }
    text
}

fn run(folder: &Path, arguments: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_posecut-ingest"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A program that refuses its options does not read its input.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

#[test]
fn a_log_from_a_file_and_from_standard_input_gives_the_same_graph() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.clf"), log()).unwrap();
    let file = run(folder.path(), &["a.clf"], b"");
    let piped = run(folder.path(), &["-", "--name", "a"], log().as_bytes());
    assert!(file.status.success() && file.stdout == piped.stdout);
    let text = String::from_utf8(file.stdout).unwrap();
    assert!(text.contains("\"session\":\"a\"") && text.matches("\"kind\":\"scan\"").count() == 4, "{text}");
}

#[test]
fn scans_and_poses_go_to_files_of_their_own_on_request() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.clf"), log()).unwrap();
    let output = run(folder.path(), &["a.clf", "--scans", "a.scans", "--trajectory", "a.tum"], b"");
    assert!(!String::from_utf8(output.stdout).unwrap().contains("\"kind\":\"scan\""));
    let lines = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap().lines().count();
    assert_eq!((lines("a.scans"), lines("a.tum")), (4, 4));
}

#[test]
fn options_of_the_other_kind_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.clf"), log()).unwrap();
    fs::create_dir(folder.path().join("2012-01-22")).unwrap();
    for (arguments, expected) in [
        (
            &["a.clf", "--wheel-scale", "0.9"][..],
            "--wheel-scale applies to NCLT sessions, but a.clf is a CARMEN log",
        ),
        (&["a.clf", "--scans", "a.clf"], "a.clf"),
        (
            &["2012-01-22", "--scan-matching"],
            "it has no hokuyo_30m.bin, so --scan-matching has no scans to match",
        ),
        (&["2012-01-22", "--scans", "x"], "--scans writes laser scans, but 2012-01-22 has no hokuyo_30m.bin"),
        (&["a.clf", "--hokuyo", "x"], "--hokuyo applies to NCLT sessions, but a.clf is a CARMEN log"),
        (&["a.clf", "--keyframe-angle", "0"], "--keyframe-angle is 0, but must be a positive number"),
    ] {
        let output = run(folder.path(), arguments, b"");
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
    assert_eq!(fs::read_to_string(folder.path().join("a.clf")).unwrap(), log());
}

#[test]
fn half_a_compressed_log_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.clf.bz2"), b"BZh91AY&SY").unwrap();
    let output = run(folder.path(), &["a.clf.bz2"], b"");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && said.contains("a.clf.bz2: cannot be decompressed"), "{said}");
}

//! Checks every program against the contract of inputs and outputs. The programs declare their rows of the table.

use std::io::Read as _;
use std::process::{Command, Stdio};

use posecut_contract::registry::{Row, table};
use posecut_contract::{program, run, samples, succeed};

pub(crate) fn streams() -> impl Iterator<Item = &'static Row> {
    table().iter().filter(|row| row.stream)
}

#[test]
fn help_and_version_are_answers() {
    for row in table() {
        let help = String::from_utf8(succeed(row.name, &["--help"], b"")).unwrap();
        assert!(help.contains("Usage:") && help.contains("--output"), "{}: {help}", row.name);
        let version = String::from_utf8(succeed(row.name, &["--version"], b"")).unwrap();
        assert_eq!(version.trim(), format!("posecut-{} {}", row.name, env!("CARGO_PKG_VERSION")));
    }
}

#[test]
fn unknown_options_are_errors() {
    for row in table() {
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
            let piped = succeed(row.name, row.arguments, &samples().bytes(input));
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

/// The system limits the size of files, which acts like a disk that fills up during a write.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_while_a_file_is_written_leaves_the_old_one() {
    // The unit is blocks of 512 bytes.
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
            said.contains("no partial output remains") && said.contains("too large"),
            "{}: {said}",
            row.name
        );
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "precious", "{}", row.name);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{}: something was left", row.name);
    }
    assert!(limited * 3 > streams().count(), "only {limited} programs write enough for the limit to matter");
}

/// Uses a folder of the kernel, because the superuser may write to any other folder.
#[cfg(target_os = "linux")]
#[test]
fn a_read_only_folder_is_an_error() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o555)).unwrap();
    let all_powerful = std::fs::write(folder.path().join("probe"), "").is_ok();
    let place = if all_powerful { std::path::Path::new("/proc/self") } else { folder.path() };
    let file = place.join("out.jsonl");
    for row in table() {
        let output = row.run(&["-o", file.to_str().unwrap()]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{}: {said}", row.name);
        assert!(said.contains("cannot be written, and no partial output remains"), "{}: {said}", row.name);
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

/// Regression: programs made a file named `-`.
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
        // The work is done, and the summary is written.
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
    for row in table().iter().filter(|row| !row.statistics.is_empty()) {
        let file = folder.path().join(format!("{}.json", row.name));
        assert!(row.run(&["--stats", file.to_str().unwrap()]).status.success(), "{}", row.name);
        let stats: serde_json::Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        assert_eq!(stats["stage"], row.name);
        for key in row.statistics {
            assert!(!stats[key].is_null(), "{}: {key} is missing in {stats}", row.name);
        }
    }
}

//! Checks on what a program must refuse, and how.

use anyhow::Context as _;
use posecut_stage::{counted, write_atomically};

use super::{Bench, Check, Verdict, must};
use crate::report::Level;

const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;
const NODES: &str = r#"{"kind":"node","id":0,"session":"a","frame":0,"pose":[0,0,0]}
{"kind":"node","id":1,"session":"b","frame":0,"pose":[1,0,0]}"#;

/// A check that an input is refused.
macro_rules! refuses {
    ($name:literal, $level:expr, $demand:literal, $input:expr) => {
        Check {
            name: $name,
            level: $level,
            demand: $demand,
            works_on_output: true,
            test: |bench| refused(bench, $input.as_bytes()),
        }
    };
}

pub(super) const CHECKS: &[Check] = &[
    refuses!("empty-input", Level::Must, "refuses an empty input", ""),
    refuses!("no-json", Level::Must, "refuses a line that is not JSON", format!("{HEADER}\nnode 0\n")),
    refuses!(
        "cut-line",
        Level::Must,
        "refuses a file that was cut short",
        format!("{HEADER}\n{NODES}\n{{\"kind\":\"landmark\",\"id\":5,\"fro")
    ),
    refuses!("no-header", Level::Must, "refuses a file without header", format!("{NODES}\n")),
    refuses!(
        "other-version",
        Level::Must,
        "refuses an unknown version of the format",
        format!("{}\n{NODES}\n", HEADER.replace("\"version\":1", "\"version\":7"))
    ),
    Check {
        name: "missing-input",
        level: Level::Must,
        demand: "refuses a missing input file",
        works_on_output: true,
        test: |bench| {
            let run = bench.program.run(&[&bench.path("missing.jsonl")], b"")?;
            Ok(must(run.status == Some(2) && run.stdout.is_empty(), || run.said()))
        },
    },
    Check {
        name: "missing-folder",
        level: Level::Must,
        demand: "refuses to write into a missing folder, and does not create it",
        works_on_output: true,
        test: missing_folder,
    },
    Check {
        name: "full-disk",
        level: Level::Must,
        demand: "exits with status 2 if its output cannot be written",
        works_on_output: true,
        test: full_disk,
    },
    refuses!(
        "not-a-number",
        Level::Should,
        "refuses NaN, which is not JSON",
        format!(
            "{HEADER}\n{NODES}\n{{\"kind\":\"landmark\",\"id\":5,\"from\":0,\"to\":1,\"measurement\":[NaN,0,0],\"information\":[1,0,0,1,0,1]}}\n"
        )
    ),
    refuses!(
        "dangling-edge",
        Level::Should,
        "refuses an edge to a missing node",
        format!("{HEADER}\n{NODES}\n{{\"kind\":\"landmark\",\"id\":5,\"from\":0,\"to\":9}}\n")
    ),
    refuses!(
        "double-id",
        Level::Should,
        "refuses two nodes with the same id",
        format!("{HEADER}\n{NODES}\n{{\"kind\":\"node\",\"id\":1,\"pose\":[2,0,0]}}\n")
    ),
    Check {
        name: "unknown-option",
        level: Level::Should,
        demand: "refuses an unknown option",
        works_on_output: true,
        test: |bench| {
            let run = bench.program.run(&["--no-such-option"], &bench.input)?;
            Ok(must(run.status == Some(2) && run.stdout.is_empty(), || run.said()))
        },
    },
    Check {
        name: "one-sentence",
        level: Level::Should,
        demand: "reports an error in one line",
        works_on_output: true,
        test: |bench| {
            let run = bench.program.run(&[], format!("{HEADER}\nnode 0\n").as_bytes())?;
            let lines = run.stderr.lines().filter(|line| !line.trim().is_empty()).count();
            Ok(must(lines == 1, || format!("it printed {lines} lines")))
        },
    },
];

/// Demands exit status 2, a message and nothing on standard output; with -o, an unchanged old file and no other files.
fn refused(bench: &Bench<'_>, input: &[u8]) -> anyhow::Result<Verdict> {
    let run = bench.program.run(&[], input)?;
    if run.status != Some(2) {
        return Ok(Err(format!("expected exit status 2, found: {}", run.said())));
    }
    if !run.stdout.is_empty() {
        return Ok(Err("it wrote to standard output before it refused".to_owned()));
    }
    if run.stderr.trim().is_empty() {
        return Ok(Err("it printed no message".to_owned()));
    }
    let parent = bench.folder.path();
    let folder = tempfile::tempdir_in(parent)
        .with_context(|| format!("{}: cannot hold a temporary folder", parent.display()))?;
    let (output, stats) = (folder.path().join("output.jsonl"), folder.path().join("stats.json"));
    write_atomically(&output, |writer| Ok(writer.write_all(b"precious")?))?;
    let text = |path: &std::path::Path| path.display().to_string();
    let run = bench.program.run(&["-", "-o", &text(&output), "--stats", &text(&stats)], input)?;
    if run.status != Some(2) {
        return Ok(Err(format!("with -o: expected exit status 2, found: {}", run.ending)));
    }
    if std::fs::read(&output).ok().as_deref() != Some(b"precious") {
        return Ok(Err("the existing file at -o was changed".to_owned()));
    }
    let left = std::fs::read_dir(folder.path())?.count();
    Ok(must(left == 1, || format!("it left {} beside the output", counted(left - 1, "file"))))
}

fn missing_folder(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    let (input, output) = (bench.input_file()?, bench.path("missing/output.jsonl"));
    let run = bench.program.run(&[&input, "-o", &output], b"")?;
    Ok(must(run.status == Some(2), || run.said()).and_then(|()| {
        must(!bench.folder.path().join("missing").exists(), || "it created the folder".to_owned())
    }))
}

fn full_disk(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    if !std::path::Path::new("/dev/full").exists() {
        return Ok(Ok(()));
    }
    let run = bench.program.run(&[&bench.input_file()?, "-o", "/dev/full"], b"")?;
    Ok(must(run.status == Some(2), || run.said()))
}

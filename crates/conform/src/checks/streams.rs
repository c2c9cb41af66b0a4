//! Checks on where a program reads from and writes to.

use super::{Bench, Check, Verdict, graph_of, must};
use crate::report::Level;
use crate::sample;

pub(super) const CHECKS: &[Check] = &[
    Check {
        name: "standard-input",
        level: Level::Must,
        demand: "reads a graph from standard input and writes a valid one to standard output",
        works_on_output: false,
        test: |bench| Ok(bench.output().map(drop)),
    },
    Check {
        name: "dash",
        level: Level::Must,
        demand: "accepts - as standard input",
        works_on_output: true,
        test: |bench| same(bench, &["-"], &bench.input),
    },
    Check {
        name: "file",
        level: Level::Must,
        demand: "reads a named file, with the same result",
        works_on_output: true,
        test: |bench| same(bench, &[&bench.input_file()?], b""),
    },
    Check {
        name: "output-file",
        level: Level::Must,
        demand: "writes to the file named with -o, and nothing to standard output",
        works_on_output: true,
        test: output_file,
    },
    Check {
        name: "pipeline-options",
        level: Level::Must,
        demand: "accepts --quiet and --stats FILE, and writes a JSON object to that file",
        works_on_output: true,
        test: pipeline_options,
    },
    Check {
        name: "no-landmark-edges",
        level: Level::Must,
        demand: "passes graphs without nodes or landmark edges through",
        works_on_output: true,
        test: nothing_to_do,
    },
    Check {
        name: "space",
        level: Level::Must,
        demand: "works in dimension 3, or refuses it with exit status 2",
        works_on_output: true,
        test: space,
    },
    Check {
        name: "compressed-input",
        level: Level::Should,
        demand: "reads gzip under any file name",
        works_on_output: true,
        test: compressed,
    },
];

/// Demands the same output as that of the first run.
fn same(bench: &Bench<'_>, arguments: &[&str], input: &[u8]) -> anyhow::Result<Verdict> {
    let run = bench.program.run(arguments, input)?;
    Ok(if run.succeeded() {
        must(run.stdout == bench.base.stdout, || {
            "the output differs from that for the same graph on standard input".to_owned()
        })
    } else {
        Err(run.said())
    })
}

fn output_file(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    let (input, output) = (bench.input_file()?, bench.path("output.jsonl"));
    let run = bench.program.run(&[&input, "-o", &output], b"")?;
    if !run.succeeded() {
        return Ok(Err(run.said()));
    }
    let Ok(written) = std::fs::read(&output) else { return Ok(Err("it wrote no file".to_owned())) };
    Ok(must(written == bench.base.stdout, || "the file differs from the output through a pipe".to_owned())
        .and_then(|()| must(run.stdout.is_empty(), || "it wrote to standard output too".to_owned())))
}

fn pipeline_options(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    let input = bench.input_file()?;
    let (output, stats) = (bench.path("quiet.jsonl"), bench.path("stats.json"));
    let run = bench.program.run(&["--quiet", &input, "-o", &output, "--stats", &stats], b"")?;
    if !run.succeeded() {
        return Ok(Err(run.said()));
    }
    let Ok(text) = std::fs::read(&stats) else { return Ok(Err("--stats wrote no file".to_owned())) };
    let object = serde_json::from_slice::<serde_json::Value>(&text).ok().filter(serde_json::Value::is_object);
    // With --quiet a program still prints its doubts.
    let doubts = object.as_ref().and_then(|object| object.get("doubts")?.as_array());
    let may_speak = doubts.is_some_and(|doubts| !doubts.is_empty());
    Ok(must(object.is_some(), || "the --stats file is not a JSON object".to_owned())
        .and_then(|()| {
            must(std::fs::read(&output).is_ok_and(|bytes| bytes == bench.base.stdout), || {
                "the output differs with these options".to_owned()
            })
        })
        .and_then(|()| {
            must(may_speak || run.stderr.is_empty(), || {
                format!("with --quiet and no doubts in --stats, it printed: {}", run.stderr.trim())
            })
        }))
}

fn nothing_to_do(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    let mut empty = bench.graph.clone();
    empty.edges.retain(|edge| edge.kind != posecut_graph::EdgeKind::Landmark);
    let odometry_alone = sample::bytes(&empty)?;
    empty.edges.clear();
    empty.nodes.clear();
    for (what, input) in [("landmark edges", odometry_alone), ("nodes", sample::bytes(&empty)?)] {
        let run = bench.program.run(&[], &input)?;
        if let Err(reason) = graph_of(&run) {
            return Ok(Err(format!("without {what}: {reason}")));
        }
    }
    Ok(Ok(()))
}

fn space(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    let run = bench.program.run(&[], &sample::bytes(&sample::space())?)?;
    if run.status == Some(2) {
        return Ok(must(run.stdout.is_empty() && !run.stderr.trim().is_empty(), || {
            "it exits with status 2, but without a message or with output".to_owned()
        }));
    }
    Ok(graph_of(&run).map(drop))
}

fn compressed(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    use std::io::Write as _;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(&bench.input)?;
    same(bench, &[], &encoder.finish()?)
}

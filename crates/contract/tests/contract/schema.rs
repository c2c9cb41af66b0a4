//! Tests that every line of a pose graph that a program writes conforms to the published schema.

use jsonschema::Validator;
use posecut_contract::{samples, succeed, workspace};

/// Checks each line against the schema; returns the number of lines.
fn hold(schema: &Validator, what: &str, bytes: &[u8]) -> usize {
    let lines = bytes.split(|&byte| byte == b'\n').filter(|line| !line.is_empty());
    lines
        .map(|line| {
            let record = serde_json::from_slice(line).unwrap();
            assert!(schema.is_valid(&record), "{what}: {record}");
        })
        .count()
}

fn schema() -> Validator {
    jsonschema::validator_for(&posecut_graph::schema()).unwrap()
}

#[test]
fn testdata_keep_to_the_schema() {
    let folder = workspace().join("testdata");
    let graphs = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut lines = 0;
    for path in graphs.filter(|path| path.extension().is_some_and(|extension| extension == "jsonl")) {
        lines += hold(&schema(), &path.display().to_string(), &std::fs::read(&path).unwrap());
    }
    assert!(lines > 1000, "{lines} lines");
}

#[test]
fn what_programs_write_keeps_to_the_schema() {
    let schema = schema();
    let (graph, optimized) = (samples().path("graph.jsonl"), samples().path("optimized.jsonl"));
    let marginals = samples().path("marginals.jsonl");
    let (session, directory) = (samples().path("session.jsonl"), samples().path("2012-01-22"));
    let written = [
        ("ingest", vec![directory.as_str()]),
        ("ingest", vec![directory.as_str(), "--dimension", "3"]),
        ("construct", vec![session.as_str(), "--radius", "8"]),
        ("pcm", vec![graph.as_str()]),
        ("ransac", vec![graph.as_str()]),
        ("readmit", vec![marginals.as_str()]),
        ("isam", vec![graph.as_str()]),
        ("islands", vec![graph.as_str()]),
        ("densest", vec![graph.as_str()]),
        ("verify", vec![graph.as_str()]),
        ("voting", vec![graph.as_str()]),
        ("multicut", vec![graph.as_str()]),
        ("oracle", vec![graph.as_str()]),
        ("optimize", vec![graph.as_str()]),
        ("inspect", vec!["filter", optimized.as_str(), "--kind", "landmark"]),
        ("convert", vec![graph.as_str(), "--to", "jsonl"]),
    ];
    for (name, arguments) in written {
        let bytes = succeed(name, &arguments, b"");
        let lines = hold(&schema, &format!("{name} {arguments:?}"), &bytes);
        assert!(lines > 50, "{name} {arguments:?} wrote {lines} lines");
    }
}

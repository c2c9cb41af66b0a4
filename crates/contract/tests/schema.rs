//! Every line that a program writes as a pose graph is one by the published schema.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_contract::{samples, succeed};

#[test]
fn what_programs_write_keeps_to_the_schema() {
    let schema = jsonschema::validator_for(&posecut_graph::schema()).unwrap();
    let (graph, optimized) = (samples().path("graph.jsonl"), samples().path("optimized.jsonl"));
    let (session, directory) = (samples().path("session.jsonl"), samples().path("2012-01-22"));
    let written = [
        ("ingest", vec![directory.as_str()]),
        ("ingest", vec![directory.as_str(), "--dimension", "3"]),
        ("construct", vec![session.as_str(), "--radius", "8"]),
        ("pcm", vec![graph.as_str()]),
        ("multicut", vec![graph.as_str()]),
        ("oracle", vec![graph.as_str()]),
        ("optimize", vec![graph.as_str()]),
        ("inspect", vec!["filter", optimized.as_str(), "--kind", "landmark"]),
        ("convert", vec![graph.as_str(), "--to", "jsonl"]),
    ];
    for (name, arguments) in written {
        let bytes = succeed(name, &arguments, b"");
        let mut lines = 0;
        for line in bytes.split(|&byte| byte == b'\n').filter(|line| !line.is_empty()) {
            let record = serde_json::from_slice(line).unwrap();
            assert!(schema.is_valid(&record), "{name} {arguments:?}: {record}");
            lines += 1;
        }
        assert!(lines > 50, "{name} {arguments:?} wrote {lines} lines");
    }
}

//! Tests that stages that estimate do not read the truth, and that all stages keep unknown fields and records.

use posecut_contract::{run, samples, succeed};
use posecut_graph::PoseGraph;
use serde_json::Value;

/// Stages that decide something about edges or poses.
const ESTIMATING: &[&str] =
    &["densest", "isam", "islands", "multicut", "optimize", "pcm", "ransac", "readmit", "verify", "voting"];

/// All stages from graph to graph.
fn stages() -> impl Iterator<Item = &'static str> {
    ESTIMATING.iter().copied().chain(["oracle"])
}

/// The sample for a stage: re-admission needs the optimiser's marginals.
fn sample(stage: &str) -> Vec<u8> {
    samples().bytes(if stage == "readmit" { "marginals.jsonl" } else { "graph.jsonl" })
}

fn read(bytes: &[u8]) -> PoseGraph {
    PoseGraph::read("test", bytes).expect("stages write sound graphs")
}

fn without_truth(bytes: &[u8]) -> Vec<u8> {
    let mut graph = read(bytes);
    graph.nodes.iter_mut().for_each(|node| node.truth = None);
    graph.edges.iter_mut().for_each(|edge| edge.truth = None);
    let mut stripped = Vec::new();
    graph.write(&mut stripped).unwrap();
    stripped
}

/// The graph without its provenance, because the digest of the input must differ.
fn without_provenance(bytes: &[u8]) -> Vec<u8> {
    let mut graph = read(bytes);
    graph.header.provenance.clear();
    let mut stripped = Vec::new();
    graph.write(&mut stripped).unwrap();
    stripped
}

#[test]
fn estimating_stages_are_blind_to_the_truth() {
    // It marks edges by the name of the stage within.
    for name in ESTIMATING.iter().copied().chain(["clean"]) {
        let seeing = sample(name);
        let blind = without_truth(&seeing);
        assert_ne!(seeing, blind, "the sample has truth");
        let with = succeed(name, &[], &seeing);
        let without = succeed(name, &[], &blind);
        assert_eq!(
            without_provenance(&without_truth(&with)),
            without_provenance(&without),
            "{name} decided otherwise without the truth"
        );
    }
}

#[test]
fn the_oracle_does_look_at_the_truth() {
    let output = run("oracle", &[], &without_truth(&samples().bytes("graph.jsonl")));
    assert_eq!(output.status.code(), Some(2), "so the test above can tell a stage that does");
}

#[test]
fn what_a_stage_does_not_know_passes_through() {
    let note = r#"{"kind":"note",  "text":"kept as it stands", "number": 1.50}"#;
    for name in stages() {
        let mut text = String::from_utf8(sample(name)).unwrap();
        text = text.replacen(
            "\"kind\":\"node\",",
            "\"kind\":\"node\",\"colour\":{\"red\":0.1,\"name\":\"\\u00e9\"},",
            1,
        );
        text = text.replacen("\"kind\":\"landmark\",", "\"kind\":\"landmark\",\"seen\":[1,null,true],", 1);
        text = text.replacen("\"dimension\":2,", "\"dimension\":2,\"licence\":\"own\",", 1);
        text.push_str(note);
        text.push('\n');
        let output = succeed(name, &[], text.as_bytes());
        let written = String::from_utf8(output.clone()).unwrap();
        assert!(written.ends_with(&format!("{note}\n")), "{name}: the unknown record changed");
        let graph = read(&output);
        assert_eq!(graph.header.extra["licence"], Value::from("own"), "{name}");
        assert_eq!(graph.nodes[0].extra["colour"]["name"], Value::from("é"), "{name}");
        let landmark = graph.edges.iter().find(|edge| edge.extra.contains_key("seen")).expect(name);
        assert_eq!(landmark.extra["seen"], serde_json::json!([1, null, true]), "{name}");
    }
}

#[test]
fn stages_mark_edges_and_never_remove_them() {
    for name in stages() {
        let before = read(&sample(name));
        let after = read(&succeed(name, &[], &sample(name)));
        let ids = |graph: &PoseGraph| graph.edges.iter().map(|edge| edge.id).collect::<Vec<_>>();
        assert_eq!(ids(&before), ids(&after), "{name}");
        // Re-admission keeps the marks of PCM.
        let own = if name == "readmit" { "pcm" } else { name };
        let own_marks =
            after.edges.iter().all(|edge| edge.rejected_by.as_deref().is_none_or(|mark| mark == own));
        assert!(own_marks, "{name} marks edges by its own name");
        let dropped = read(&succeed(name, &["--drop-rejected"], &sample(name)));
        assert_eq!(dropped.edges.len(), after.edges.iter().filter(|edge| edge.in_use()).count(), "{name}");
        assert_eq!(
            after.header.provenance.len(),
            before.header.provenance.len() + 1,
            "{name} signs its work"
        );
    }
}

#[test]
fn an_edge_rejected_before_stays_rejected_by_who_did_it() {
    let pcm = succeed("pcm", &[], &samples().bytes("graph.jsonl"));
    let both = read(&succeed("multicut", &[], &pcm));
    for (before, after) in read(&pcm).edges.iter().zip(&both.edges) {
        if let Some(mark) = &before.rejected_by {
            assert_eq!(after.rejected_by.as_ref(), Some(mark));
            assert_eq!(after.cost, None, "a rejected edge takes no part in the cut");
        }
    }
}

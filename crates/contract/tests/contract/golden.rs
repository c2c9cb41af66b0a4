//! Tests that the stages give the recorded results for testdata/graph.jsonl. To change the expectations on purpose, run
//! `cargo xtask test-data`.

use posecut_contract::{succeed, workspace};
use posecut_graph::PoseGraph;

fn testdata(name: &str) -> Vec<u8> {
    std::fs::read(workspace().join("testdata").join(name)).unwrap()
}

fn rejected(method: &str) -> Vec<u64> {
    let graph = PoseGraph::read(method, succeed(method, &[], &testdata("graph.jsonl")).as_slice()).unwrap();
    graph.edges.iter().filter(|edge| !edge.in_use()).map(|edge| edge.id).collect()
}

#[test]
fn the_same_edges_are_rejected() {
    for method in ["pcm", "multicut"] {
        let expected = String::from_utf8(testdata(&format!("{method}.rejected"))).unwrap();
        let expected: Vec<u64> = expected.lines().map(|line| line.parse().unwrap()).collect();
        assert!(!expected.is_empty());
        // Compare exactly: decisions depend on gates and integer costs, and no edge is so close to a gate that rounding matters.
        assert_eq!(rejected(method), expected, "{method}");
    }
}

#[test]
fn the_same_map_comes_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let oracle = succeed("oracle", &[], &testdata("graph.jsonl"));
    succeed("optimize", &["-o", &path("reference.jsonl")], &oracle);
    for method in ["pcm", "multicut"] {
        let marked = succeed(method, &[], &testdata("graph.jsonl"));
        let optimized = succeed("optimize", &[], &marked);
        let stats = path("stats.json");
        succeed("evaluate", &["--reference", &path("reference.jsonl"), "--stats", &stats], &optimized);
        let found: serde_json::Value = serde_json::from_slice(&std::fs::read(&stats).unwrap()).unwrap();
        let expected = String::from_utf8(testdata(&format!("{method}.stats"))).unwrap();
        let number = |name: &str| -> f64 {
            let line = expected.lines().find(|line| line.contains(&format!("\"{name}\""))).unwrap();
            line.split(':').nth(1).unwrap().trim().trim_end_matches(',').parse().unwrap()
        };
        for name in ["true_positive", "false_positive", "false_negative", "true_negative"] {
            assert_eq!(found["edges"][name].as_f64(), Some(number(name)), "{method}: {name}");
        }
        // Compare approximately: another processor may sum in another order, and optimisation stops at a relative change of
        // 1e-10 of the cost, so lengths may differ from about the seventh digit on.
        let (found, expected) = (found["rmse"].as_f64().unwrap(), number("rmse"));
        let distance = (found - expected).abs();
        println!("{method}: rmse {found}, expected {expected}, distance {distance:e}");
        assert!(distance <= 1e-5 * expected + 1e-6, "{method}: rmse {found}, expected {expected}");
    }
}

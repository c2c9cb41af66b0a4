//! Several files become the sessions or robots of one graph.

use std::collections::BTreeMap;

use posecut_graph::{EdgeKind, PoseGraph};

use crate::program::{converted, folder, refused};

/// A chain of two vertices that begins with this id.
fn robot(key: u64) -> String {
    let next = key + 1;
    format!("VERTEX_SE2 {key} 0 0 0\nVERTEX_SE2 {next} 1 0 0\nEDGE_SE2 {key} {next} 1 0 0 1 0 0 1 0 1\n")
}

/// Session, frame and id of the nodes.
fn nodes(graph: &PoseGraph) -> Vec<(&str, i64, u64)> {
    graph.nodes.iter().map(|node| (node.session.as_deref().unwrap(), node.frame.unwrap(), node.id)).collect()
}

/// The robots' own keys stay, so that an edge between two robots finds both ends.
#[test]
fn gtsam_keys_become_robots() {
    let (a, b) = (97 << 56, 98 << 56);
    let between = format!("EDGE_SE2 {a} {b} 3 2 0 1 0 0 1 0 1\n");
    let folder = folder(&[("0.g2o", &(robot(a) + &between)), ("1.g2o", &(robot(b) + &between))]);
    let (graph, _) = converted(folder.path(), &["0.g2o", "1.g2o"]);
    assert_eq!(nodes(&graph), [("a", 0, a), ("a", 1, a + 1), ("b", 0, b), ("b", 1, b + 1)]);
    assert_eq!(graph.edges_of(EdgeKind::Landmark).count(), 1);
}

#[test]
fn ids_that_clash_are_refused_and_renumber_makes_sessions_of_the_files() {
    let folder = folder(&[
        ("monday.g2o", &robot(0)),
        ("tuesday.g2o", &robot(0).replace(" 1 0 0\nEDGE", " 2 0 0\nEDGE")),
    ]);
    let said = refused(folder.path(), &["monday.g2o", "tuesday.g2o"]);
    assert!(said.contains("tuesday.g2o, line 2") && said.contains("vertex 1 occurs twice"), "{said}");
    assert!(said.contains("--renumber"), "{said}");
    let (graph, _) = converted(folder.path(), &["monday.g2o", "tuesday.g2o", "--renumber"]);
    assert_eq!(nodes(&graph), [("monday", 0, 0), ("monday", 1, 1), ("tuesday", 0, 2), ("tuesday", 1, 3)]);
    let ends: BTreeMap<u64, (u64, u64)> =
        graph.edges.iter().map(|edge| (edge.id, (edge.from, edge.to))).collect();
    assert_eq!(ends, BTreeMap::from([(0, (0, 1)), (1, (2, 3))]));
    let named = ["monday.g2o", "tuesday.g2o", "--renumber", "--session", "m", "--session", "t"];
    assert_eq!(nodes(&converted(folder.path(), &named).0)[2], ("t", 0, 2));
    let said = refused(folder.path(), &named[..5]);
    assert!(said.contains("--session names 1 session, but there are 2 files"), "{said}");
    let said = refused(folder.path(), &["monday.g2o", "tuesday.g2o", "--session", "m", "--session", "t"]);
    assert!(said.contains("--renumber"), "{said}");
}

#[test]
fn trajectories_are_sessions_named_by_their_files() {
    let drive = "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n";
    let folder = folder(&[("monday/drive.tum", drive), ("tuesday/drive.tum", drive), ("x.g2o", &robot(0))]);
    let odometry = ["--odometry-from-poses", "--sigma-translation", "1", "--sigma-rotation", "1"];
    let files = ["monday/drive.tum", "tuesday/drive.tum"];
    let (graph, _) = converted(folder.path(), &[&files[..], &odometry].concat());
    let sessions: Vec<&str> = nodes(&graph).iter().map(|(session, ..)| *session).collect();
    assert_eq!(sessions, ["monday/drive", "monday/drive", "tuesday/drive", "tuesday/drive"]);
    // No odometry between the sessions.
    let ends: Vec<(u64, u64)> = graph.edges.iter().map(|edge| (edge.from, edge.to)).collect();
    assert_eq!(ends, [(0, 1), (2, 3)]);
    let said = refused(folder.path(), &["monday/drive.tum", "monday/drive.tum"]);
    assert!(said.contains("would both be session \"monday/drive\""), "{said}");
    let said = refused(folder.path(), &["monday/drive.tum", "x.g2o"]);
    assert!(said.contains("x.g2o: its format is g2o, but that of monday/drive.tum is TUM"), "{said}");
}

/// The name of a file says less than its content.
#[test]
fn formats_are_recognised_by_content() {
    let folder = folder(&[
        ("map.txt", &robot(0)),
        ("wrong.tum", &robot(0)),
        ("notes.txt", "measured on Monday\n"),
        ("result.jrl.cbor", "\u{0}"),
    ]);
    for file in ["map.txt", "wrong.tum"] {
        assert_eq!(converted(folder.path(), &[file]).0.edges.len(), 1, "{file}");
    }
    let said = refused(folder.path(), &["notes.txt"]);
    assert!(said.contains("notes.txt: neither the content nor the name"), "{said}");
    assert!(said.contains("--from to jsonl, g2o, toro, jrl, tum or kitti"), "{said}");
    std::fs::write(folder.path().join("result.jrl.cbor"), b"\xa4dname").unwrap();
    let said = refused(folder.path(), &["result.jrl.cbor"]);
    assert!(said.contains("CBOR") && said.contains("cbor2.load"), "{said}");
}

/// Edges used to take the noise model of the same name from the first file.
#[test]
fn graphs_with_different_noise_models_are_joined() {
    let graph = |weight: u32| {
        format!(
            "{{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2,\"noise_models\":{{\"odometry\":{{\"information\":[{weight},0,0,{weight},0,{weight}]}}}}}}\n\
             {{\"kind\":\"node\",\"id\":0,\"session\":\"s\",\"frame\":0}}\n{{\"kind\":\"node\",\"id\":1,\"session\":\"s\",\"frame\":1}}\n\
             {{\"kind\":\"odometry\",\"id\":0,\"from\":0,\"to\":1,\"measurement\":[1,0,0],\"noise\":\"odometry\"}}\n"
        )
    };
    let folder = folder(&[("a.jsonl", &graph(4)), ("b.jsonl", &graph(9))]);
    let (graph, _) = converted(folder.path(), &["a.jsonl", "b.jsonl", "--renumber"]);
    assert_eq!(graph.sessions(), ["a", "b"]);
    let weights: Vec<f64> = graph.edges.iter().map(|edge| graph.information(edge).unwrap()[0]).collect();
    assert_eq!(weights, [4.0, 9.0]);
    let said = refused(folder.path(), &["a.jsonl", "b.jsonl"]);
    assert!(
        said.contains("b.jsonl: several JSON Lines files cannot be joined") && said.contains("--renumber"),
        "{said}"
    );
}

//! Graphs that are barely graphs, through the stage's library: the result is defined, and nothing panics.

use posecut_geometry::SE2;
use posecut_graph::PoseGraph;
use posecut_pcm::candidate::group;
use posecut_pcm::chain::{Chains, Covariances};
use posecut_pcm::consistency::Pairs;
use posecut_pcm::{Gate, PcmError, Test};

const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;

fn graph(lines: &[&str]) -> PoseGraph {
    PoseGraph::read("test", format!("{HEADER}\n{}\n", lines.join("\n")).as_bytes()).unwrap()
}

fn nodes(count: usize) -> Vec<String> {
    (0..count).map(|id| format!(r#"{{"kind":"node","id":{id},"pose":[{id},0,0]}}"#)).collect()
}

fn edge(kind: &str, id: u64, from: u64, to: u64, information: &str) -> String {
    format!(
        r#"{{"kind":"{kind}","id":{id},"from":{from},"to":{to},"measurement":[{},0,0],"information":{information}}}"#,
        to as i64 - from as i64
    )
}

const GOOD: &str = "[100,0,0,100,0,400]";

fn with(mut lines: Vec<String>, more: &[String]) -> PoseGraph {
    lines.extend_from_slice(more);
    graph(&lines.iter().map(String::as_str).collect::<Vec<_>>())
}

#[test]
fn a_candidate_into_a_gap_of_the_odometry_joins_the_pieces_it_touches() {
    // 0-1-2, a gap, 3-4-5; node 6 has no odometry at all.
    let odometry: Vec<String> = [(0, 1), (1, 2), (3, 4), (4, 5)]
        .iter()
        .enumerate()
        .map(|(id, &(from, to))| edge("odometry", id as u64, from, to, GOOD))
        .collect();
    let landmarks = [
        edge("landmark", 10, 0, 3, GOOD),
        edge("landmark", 11, 2, 5, GOOD),
        edge("landmark", 12, 1, 6, GOOD),
    ];
    let graph = with(nodes(7), &[&odometry[..], &landmarks[..]].concat());
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let found: Vec<(usize, usize, usize)> =
        grouped.groups.iter().map(|group| (group.a, group.b, group.candidates.len())).collect();
    assert_eq!(found, [(0, 1, 2), (0, 2, 1)]);
    let (matrix, _) =
        Pairs::new(&chains, &grouped.groups[0]).graph(Gate::new(Test::Mahalanobis, 0.99, 3).unwrap());
    assert!(matrix.connected(0, 1), "both claim the same across the gap");
}

#[test]
fn singular_and_indefinite_information_of_a_landmark_edge_is_refused_with_the_edge() {
    for information in ["[100,0,0,100,0,0]", "[0,0,0,0,0,0]", "[1,1,0,1,0,1]"] {
        let graph = with(nodes(2), &[edge("landmark", 7, 0, 1, information)]);
        let chains = Chains::<SE2, 3>::of(&graph).unwrap();
        let error = group(&graph, &chains).unwrap_err();
        assert!(matches!(&error, PcmError::Covariance { edge, .. } if edge == "landmark 7"), "{error}");
        // The test that reads no covariances takes the graph.
        let chains = Chains::<SE2, 3>::with(&graph, Covariances::Ignored).unwrap();
        assert!(posecut_pcm::candidate::group_with(&graph, &chains, Covariances::Ignored).is_ok());
    }
    let indefinite =
        format!("{HEADER}\n{}\n{}\n", nodes(2).join("\n"), edge("landmark", 7, 0, 1, "[1,2,0,1,0,1]"));
    let error = PoseGraph::read("test", indefinite.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("landmark") || error.contains("information"), "{error}");
}

#[test]
fn a_session_of_one_node_can_have_candidates() {
    let odometry = [edge("odometry", 0, 0, 1, GOOD)];
    let landmarks = [edge("landmark", 5, 0, 2, GOOD), edge("landmark", 6, 1, 2, GOOD)];
    let graph = with(nodes(3), &[&odometry[..], &landmarks[..]].concat());
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let (matrix, counts) =
        Pairs::new(&chains, &grouped.groups[0]).graph(Gate::new(Test::Mahalanobis, 0.99, 3).unwrap());
    assert_eq!((matrix.edges(), counts.pairs, counts.indefinite), (1, 1, 0));
}

#[test]
fn a_candidate_from_a_node_to_itself_is_a_candidate_of_its_chain() {
    let odometry = [edge("odometry", 0, 0, 1, GOOD)];
    let graph = with(nodes(2), &[&odometry[..], &[edge("landmark", 5, 0, 1, GOOD)]].concat());
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    assert_eq!(group(&graph, &chains).unwrap().groups.len(), 1);
}

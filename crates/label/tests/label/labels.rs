//! Tests labels from every source, and refusals.

use posecut_graph::{EdgeKind, PoseGraph};
use posecut_label::{pairs, table};
use proptest::prelude::*;

/// A graph of ten nodes in a row, with landmark edges between these pairs.
fn graph(landmarks: &[(u64, u64)]) -> PoseGraph {
    let mut text =
        String::from("{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n");
    for id in 0..10 {
        text += &format!("{{\"kind\":\"node\",\"id\":{id}}}\n");
    }
    for (id, (from, to)) in landmarks.iter().enumerate() {
        text += &format!(
            "{{\"kind\":\"landmark\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[0,0,0],\"information\":[1,0,0,1,0,1]}}\n"
        );
    }
    PoseGraph::read("test", text.as_bytes()).unwrap()
}

fn labels(graph: &PoseGraph) -> Vec<bool> {
    graph.edges_of(EdgeKind::Landmark).map(|edge| edge.truth_correct().unwrap()).collect()
}

fn by_table(landmarks: &[(u64, u64)], text: &str) -> Result<Vec<bool>, String> {
    let mut graph = graph(landmarks);
    table::read("labels.csv", text.as_bytes())
        .and_then(|rows| table::apply(&mut graph, "labels.csv", &rows))
        .map(|()| labels(&graph))
        .map_err(|error| format!("{error:#}"))
}

fn by_pairs(landmarks: &[(u64, u64)], text: &str) -> Result<Vec<bool>, String> {
    let mut graph = graph(landmarks);
    pairs::read("pairs.txt", text.as_bytes())
        .and_then(|list| pairs::apply(&mut graph, "pairs.txt", &list))
        .map(|()| labels(&graph))
        .map_err(|error| format!("{error:#}"))
}

#[test]
fn a_table_labels_edges_by_columns_in_any_order() {
    let text = "inlier,note,j,kind,i\n1,x,5,loop,0\n0,y,6,loop,1\n1,z,1,odom,0\n";
    assert_eq!(by_table(&[(0, 5), (1, 6)], text).unwrap(), [true, false]);
    // Without a column `kind` every row is a landmark edge. An edge in the other direction is found too.
    assert_eq!(by_table(&[(6, 1), (0, 5)], "i,j,inlier\n0,5,true\n1,6,false\n").unwrap(), [false, true]);
}

#[test]
fn edges_of_the_same_pair_are_taken_in_order() {
    let text = "i,j,inlier\n0,5,0\n0,5,1\n5,0,1\n";
    assert_eq!(by_table(&[(0, 5), (0, 5), (5, 0)], text).unwrap(), [false, true, true]);
    // An edge gets the row of its own direction, even if another row comes first.
    assert_eq!(by_table(&[(5, 0), (0, 5)], "i,j,inlier\n0,5,0\n5,0,1\n").unwrap(), [true, false]);
}

#[test]
fn labels_of_another_graph_are_refused_with_file_line_and_edge() {
    let cases = [
        ("i,j,inlier\n0,5,1\n3,9,0\n", "labels.csv, line 3: labels an edge 3 9"),
        ("i,j,inlier\n", "labels.csv: has no label for landmark 0 (0 5)"),
        ("i,j\n0,5\n", "line 1: the header has no column \"inlier\""),
        ("i,j,inlier\n0,5,maybe\n", "line 2: inlier is \"maybe\""),
        ("i,j,inlier\n0,x,1\n", "line 2: j is \"x\""),
        ("i,j,inlier\n0,5,1\n0,5,1\n", "labels.csv, line 3: labels an edge 0 5"),
    ];
    for (text, told) in cases {
        let said = by_table(&[(0, 5)], text).unwrap_err();
        assert!(said.contains(told), "{told} in {said}");
    }
    let said = by_pairs(&[(0, 5)], "5 0\n2 3\n").unwrap_err();
    assert!(said.contains("pairs.txt, line 2: calls 2 3 correct"), "{said}");
    let said = by_pairs(&[(0, 5)], "5\n").unwrap_err();
    assert!(said.contains("pairs.txt, line 1: expected two node ids"), "{said}");
}

#[test]
fn listed_pairs_are_correct_in_either_direction_and_all_others_not() {
    assert_eq!(by_pairs(&[(0, 5), (1, 6), (5, 0)], "5 0\n").unwrap(), [true, false, true]);
    assert_eq!(by_pairs(&[(0, 5)], "").unwrap(), [false]);
}

proptest! {
    /// A table of all edges of a graph gives exactly its labels, in any order of rows.
    #[test]
    fn a_table_of_the_graphs_own_edges_is_read_back(
        edges in prop::collection::vec((0_u64..5, 5_u64..10, any::<bool>()), 1..20),
        rotation in 0_usize..20,
    ) {
        let mut known = std::collections::BTreeMap::new();
        let unique: Vec<_> =
            edges.into_iter().filter(|&(from, to, correct)| known.insert((from, to), correct).is_none()).collect();
        let ends: Vec<(u64, u64)> = unique.iter().map(|&(from, to, _)| (from, to)).collect();
        let mut rows: Vec<String> =
            unique.iter().map(|(from, to, correct)| format!("{from},{to},{}\n", u8::from(*correct))).collect();
        let middle = rotation % rows.len();
        rows.rotate_left(middle);
        let found = by_table(&ends, &format!("i,j,inlier\n{}", rows.concat())).unwrap();
        prop_assert_eq!(found, unique.iter().map(|edge| edge.2).collect::<Vec<_>>());
    }
}

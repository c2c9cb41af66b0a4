//! Which edges are odometry, in files that do not say it.

use posecut_graph::{EdgeKind, PoseGraph};

use crate::program::{converted, folder};

/// A chain of these ids, and a closure from its end to its start.
fn chain(ids: &[u64]) -> String {
    let mut text = String::new();
    for id in ids {
        text += &format!("VERTEX_SE2 {id} {id} 0 0\n");
    }
    let closure = [ids[ids.len() - 1], ids[0]];
    for ends in ids.windows(2).chain([&closure[..]]) {
        text += &format!("EDGE_SE2 {} {} 1 0 0 1 0 0 1 0 1\n", ends[0], ends[1]);
    }
    text
}

fn odometry(graph: &PoseGraph) -> Vec<(u64, u64)> {
    graph.edges_of(EdgeKind::Odometry).map(|edge| (edge.from, edge.to)).collect()
}

/// Ids 0, 10, 20 used to make all odometry into closures without a word.
#[test]
fn ids_in_steps_of_ten_are_a_chain() {
    let folder = folder(&[("tens.g2o", &chain(&[0, 10, 20, 30]))]);
    let expected = [(0, 10), (10, 20), (20, 30)];
    let (graph, said) = converted(folder.path(), &["tens.g2o"]);
    assert_eq!(odometry(&graph), expected);
    assert!(
        said.contains("no edge joins ids n and n + 1, so 3 edges") && said.contains("(first: 0 10)"),
        "{said}"
    );
    let (graph, said) = converted(folder.path(), &["tens.g2o", "--odometry", "next-id"]);
    assert_eq!((odometry(&graph), said.as_str()), (expected.to_vec(), ""));
    let (graph, said) = converted(folder.path(), &["tens.g2o", "--odometry", "consecutive"]);
    assert_eq!((odometry(&graph), said.as_str()), (vec![], ""));
    let (graph, _) = converted(folder.path(), &["tens.g2o", "--odometry", "none"]);
    assert_eq!(odometry(&graph), []);
}

#[test]
fn consecutive_ids_win_and_each_robot_is_judged_alone() {
    // A gap from 2 to 10: with consecutive ids in the file, a step across a gap is a closure.
    let (a, b) = (97 << 56, 98 << 56);
    let folder = folder(&[
        ("gap.g2o", &chain(&[0, 1, 2, 10])),
        ("robots.g2o", &(chain(&[a, a + 1, a + 2]) + &chain(&[b, b + 5, b + 10]))),
    ]);
    let (graph, said) = converted(folder.path(), &["gap.g2o"]);
    assert_eq!((odometry(&graph), said.as_str()), (vec![(0, 1), (1, 2)], ""));
    let (graph, _) = converted(folder.path(), &["gap.g2o", "--odometry", "next-id"]);
    assert_eq!(odometry(&graph), [(0, 1), (1, 2), (2, 10)]);
    let (graph, said) = converted(folder.path(), &["robots.g2o"]);
    assert_eq!(odometry(&graph), [(a, a + 1), (a + 1, a + 2), (b, b + 5), (b + 5, b + 10)]);
    assert!(said.contains("so 2 edges"), "{said}");
}

#[test]
fn sparse_closures_of_a_file_without_odometry_stay_closures() {
    let mut text = "EDGE_SE2 0 10 1 0 0 1 0 0 1 0 1\n".to_owned();
    for id in 0..10 {
        text += &format!("VERTEX_SE2 {} 0 0 0\n", 10 * id);
    }
    let folder = folder(&[("closures.g2o", &text)]);
    let (graph, said) = converted(folder.path(), &["closures.g2o"]);
    assert_eq!((odometry(&graph), said.as_str()), (vec![], ""));
}

//! What is written, and when.

use crate::{LAP, clean, landmark_edges, laps, only, stderr};

const WRONG: [(usize, usize); 3] = [(3, 18), (25, 95), (60, 7)];

#[test]
fn a_graph_comes_back_in_its_own_format_without_its_wrong_edges() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.g2o"), laps(&WRONG)).unwrap();
    let output = clean(
        folder.path(),
        &["map.g2o", "-o", "clean.g2o", "--edges", "edges.csv", "--stats", "stats.json"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(output.stdout.is_empty());
    let kept = landmark_edges(&std::fs::read_to_string(folder.path().join("clean.g2o")).unwrap());
    let expected: Vec<_> = (LAP..3 * LAP).step_by(2).map(|node| (node - LAP, node)).collect();
    assert_eq!(kept, expected, "{}", stderr(&output));
    let said = stderr(&output);
    for part in [
        "map.g2o: 1 session, 120 poses, 119 odometry edges, 43 landmark edges",
        "in use     40",
        "rejected   3",
        "clean.g2o (g2o, without 3 rejected landmark edges)",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let mut rows = csv::Reader::from_path(folder.path().join("edges.csv")).unwrap();
    let verdict = rows.headers().unwrap().iter().position(|name| name == "verdict").unwrap();
    let verdicts: Vec<String> = rows.records().map(|row| row.unwrap()[verdict].to_owned()).collect();
    assert_eq!(verdicts.len(), 43);
    assert_eq!(verdicts.iter().filter(|verdict| *verdict == "accepted").count(), 40);
    let stats = std::fs::read_to_string(folder.path().join("stats.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_str(&stats).unwrap();
    assert_eq!((&stats["in_use"], &stats["converged"]), (&40.into(), &true.into()), "{stats}");
}

#[test]
fn json_lines_keep_rejected_edges_with_a_mark() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.g2o"), laps(&WRONG)).unwrap();
    clean(folder.path(), &["map.g2o", "-o", "marked.jsonl"]);
    clean(folder.path(), &["map.g2o", "-o", "dropped.jsonl", "--drop-rejected"]);
    let count = |name: &str| {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        (text.matches("\"kind\":\"landmark\"").count(), text.matches("\"rejected_by\":\"verify\"").count())
    };
    assert_eq!((count("marked.jsonl"), count("dropped.jsonl")), ((43, 3), (40, 0)));
}

#[test]
fn input_and_output_may_be_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("map.g2o");
    std::fs::write(&map, laps(&WRONG)).unwrap();
    assert!(clean(folder.path(), &["map.g2o", "-o", "map.g2o"]).status.success());
    let once = std::fs::read_to_string(&map).unwrap();
    assert_eq!(landmark_edges(&once).len(), 40);
    // A clean graph stays as it is, apart from the last digits of its poses.
    let again = clean(folder.path(), &["map.g2o"]);
    assert_eq!(landmark_edges(&String::from_utf8(again.stdout.clone()).unwrap()).len(), 40);
    assert!(stderr(&again).contains("moved by 0.00 m (median), 0.00 m (most)"), "{}", stderr(&again));
}

#[test]
fn an_edge_can_be_explained() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.g2o"), laps(&WRONG)).unwrap();
    let output = clean(folder.path(), &["map.g2o", "--explain", "160"]);
    let said = stderr(&output);
    assert!(said.contains("edge 160 from node 25 to node 95: rejected"), "{said}");
}

#[test]
fn undecided_edges_can_stay_in_use() {
    let folder = tempfile::tempdir().unwrap();
    // One closure of a path with loose odometry: nothing supports it, and nothing contradicts it.
    let alone = only(&laps(&[]), |line| {
        !line.starts_with("EDGE") || {
            let mut words = line.split(' ').skip(1).map(|word| word.parse::<usize>().unwrap());
            let (from, to) = (words.next().unwrap(), words.next().unwrap());
            to == from + 1 || to == 58
        }
    })
    .replace(" 1000 0 0 1000 0 40000", " 0.1 0 0 0.1 0 1");
    std::fs::write(folder.path().join("map.g2o"), alone).unwrap();
    for (choice, edges) in [("reject", 0), ("keep", 1)] {
        let output = clean(folder.path(), &["map.g2o", "--undecided", choice]);
        let text = String::from_utf8(output.stdout.clone()).unwrap();
        assert_eq!(landmark_edges(&text).len(), edges, "{choice}: {}", stderr(&output));
    }
}

//! Tests that reports show the consistency graph on which PCM decided, with any options.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use posecut_contract::{session_with_landmarks, succeed};
use posecut_graph::PoseGraph;
use posecut_report::consistency::matrix;

/// The pairs of edge ids that a DIMACS file connects.
fn pairs(dimacs: &str) -> BTreeSet<(u64, u64)> {
    let words: Vec<Vec<&str>> = dimacs.lines().map(|line| line.split(' ').collect()).collect();
    let number = |word: &str| word.parse::<u64>().unwrap();
    let named = words.iter().filter(|words| words[..2] == ["c", "vertex"]);
    let id: BTreeMap<u64, u64> = named.map(|words| (number(words[2]), number(words[4]))).collect();
    let joined = words.iter().filter(|words| words[0] == "e");
    joined
        .map(|words| (id[&number(words[1])], id[&number(words[2])]))
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect()
}

#[test]
fn the_matrix_is_the_graph_that_pcm_wrote() {
    let folder = tempfile::tempdir().unwrap();
    // Longer than the samples, with enough landmark edges that the options matter.
    session_with_landmarks(folder.path(), "800", "10");
    let graph = folder.path().join("graph.jsonl").to_str().unwrap().to_owned();
    let dimacs = folder.path().join("graph.dimacs");
    let mut seen = BTreeSet::new();
    for options in [
        &[][..],
        &["--test", "root", "--probability", "0.9"],
        &["--test", "threshold", "--translation-per-step", "0.02", "--rotation-per-step", "0.002"],
        &["--correction", "group"],
        &["--scale", "3"],
        &["--scale", "0.1,0.5"],
        &["--scale", "auto"],
        &["--calibrate", "--scale", "auto"],
        &["--no-odometry-test"],
    ] {
        let mut arguments = vec![graph.as_str(), "--consistency-graph", dimacs.to_str().unwrap()];
        arguments.extend(options);
        let graph = PoseGraph::read("pcm", succeed("pcm", &arguments, b"").as_slice()).unwrap();
        let matrix = matrix(&graph).unwrap().unwrap();
        let id = |place: usize| graph.edges[matrix.edges[place]].id;
        let shown: BTreeSet<(u64, u64)> = (0..matrix.edges.len())
            .flat_map(|one| (0..one).map(move |other| (one, other)))
            .filter(|&(one, other)| matrix.consistent(one, other))
            .map(|(one, other)| (id(one).min(id(other)), id(one).max(id(other))))
            .collect();
        assert_eq!(shown, pairs(&fs::read_to_string(&dimacs).unwrap()), "{options:?}");
        seen.insert(shown.len());
    }
    assert!(seen.len() > 4, "the options make a difference: {seen:?}");
}

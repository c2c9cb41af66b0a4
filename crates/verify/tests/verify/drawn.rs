//! Graphs of which everything is drawn, and that were judged wrongly once.

use posecut_graph::for_dimension;
use posecut_simulate_graph::{Options, simulate};
use posecut_verify::verdict::Verdict;
use posecut_verify::verify;

/// Numbers of incorrect edges accepted, and of correct edges not accepted, of the graph with this seed.
fn mistakes(seed: u64) -> [usize; 2] {
    let graph = simulate(&Options { seed, ..Options::default() }).unwrap().graph;
    let findings =
        for_dimension!(graph.header.dimension, |G, DOF| verify::<G, DOF>(&graph)).unwrap().findings;
    let mut mistakes = [0; 2];
    for finding in findings {
        let is_correct = graph.edges[finding.edge].truth_correct().unwrap();
        if (finding.verdict == Verdict::Accepted) != is_correct {
            mistakes[usize::from(is_correct)] += 1;
        }
    }
    mistakes
}

/// Regressions: edges off by metres were explained by odometry four to 150 times as uncertain as it claims, although local errors explained all
/// loops better by 100 nats and more. Of the incorrect edges, 69, 16, 20, 19 and 27 were accepted.
#[test]
fn errors_of_metres_are_not_taken_for_drift() {
    for seed in [31, 37, 1046, 1054, 1071] {
        let [kept, lost] = mistakes(seed);
        assert!(kept <= 2, "seed {seed}: {kept} incorrect edges kept");
        assert!(lost <= 13, "seed {seed}: {lost} correct edges lost");
    }
}

/// Regressions: local errors wider than thirty deviations of the claim were not sought, and 91 and 10 incorrect edges were accepted. On the
/// last graph no noise is mistaken, and local errors explain more all the same.
#[test]
fn wide_local_errors_are_found_where_they_explain_much_more() {
    for seed in [33, 1089, 1119] {
        let [kept, lost] = mistakes(seed);
        assert!(kept <= 9, "seed {seed}: {kept} incorrect edges kept");
        assert!(lost <= 26, "seed {seed}: {lost} correct edges lost");
    }
}

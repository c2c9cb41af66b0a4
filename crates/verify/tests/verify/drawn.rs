//! Graphs of which everything is drawn, and that were judged wrongly once.

use posecut_simulate_graph::{Options, simulate};

use crate::mistakes::{Mistakes, mistakes};

/// The mistakes on the graph with this seed.
fn mistakes_of(seed: u64) -> Mistakes {
    mistakes(&simulate(&Options { seed, ..Options::default() }).unwrap().graph)
}

/// Regressions: edges off by metres were explained by odometry four to 150 times as uncertain as it claims, although local errors explained all
/// loops better by 100 nats and more. Of the incorrect edges, 69, 16, 20, 19 and 27 were accepted.
#[test]
fn errors_of_metres_are_not_taken_for_drift() {
    for seed in [31, 37, 1046, 1054, 1071] {
        let Mistakes { kept, lost, .. } = mistakes_of(seed);
        assert!(kept <= 2, "seed {seed}: {kept} incorrect edges kept");
        assert!(lost <= 13, "seed {seed}: {lost} correct edges lost");
    }
}

/// Regressions: local errors wider than thirty deviations of the claim were not sought, and 91 and 10 incorrect edges were accepted. On the
/// last graph no noise is mistaken, and local errors explain more all the same.
#[test]
fn wide_local_errors_are_found_where_they_explain_much_more() {
    for seed in [33, 1089, 1119] {
        let Mistakes { kept, lost, .. } = mistakes_of(seed);
        assert!(kept <= 9, "seed {seed}: {kept} incorrect edges kept");
        assert!(lost <= 26, "seed {seed}: {lost} correct edges lost");
    }
}

/// Regressions: the robot slips far from the groups of edges that span the slip, and 89, 42, 12 and 190 correct edges were lost. On the graph of
/// seed 1022, whose calibration explained slips as noise, 116.
#[test]
fn edges_that_span_a_slip_are_accepted_wherever_it_is() {
    for (seed, most) in [(12, 1), (39, 4), (1022, 20), (1088, 1), (1101, 1)] {
        let Mistakes { kept, lost, .. } = mistakes_of(seed);
        assert!(kept <= 15, "seed {seed}: {kept} incorrect edges kept");
        assert!(lost <= most, "seed {seed}: {lost} correct edges lost");
    }
}

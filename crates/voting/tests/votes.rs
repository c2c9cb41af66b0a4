//! Votes on a model whose optimum is known, and on small pose graphs.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::PoseGraph;
use posecut_voting::fit::Parts;
use posecut_voting::{Election, Fit, Optimiser, Quantiles, vote};
use proptest::prelude::*;

/// The simplest possible graph: every edge measures one number of three components, and the optimum is the mean. True edges
/// measure nearly zero, false edges any number.
fn fit_of_means(values: &[f64]) -> impl Fn(&[usize]) -> Fit + Sync + '_ {
    move |edges| {
        let mean = edges.iter().map(|&edge| values[edge]).sum::<f64>() / edges.len().max(1) as f64;
        let residuals: Vec<f64> = edges.iter().map(|&edge| 3.0 * (values[edge] - mean).powi(2)).collect();
        Fit { chi_square: residuals.iter().sum(), redundancy: 3 * edges.len().saturating_sub(1), residuals }
    }
}

fn quantiles() -> Quantiles {
    Quantiles::new(0.99, 3).unwrap()
}

#[test]
fn clusters_that_contradict_the_majority_go() {
    // The mean of all values is 1.7. Next to it each true edge still passes, and so becomes a candidate.
    let values = [0.1, -0.1, 0.2, 6.0, 6.1, 0.0, -0.2];
    let clusters = [vec![0, 1], vec![2], vec![3, 4], vec![5, 6]];
    let verdict = vote(&clusters, quantiles(), Election::Joint, &fit_of_means(&values));
    assert_eq!(verdict.kept, [0, 1, 2, 5, 6]);
    assert_eq!((verdict.clusters_consistent, verdict.clusters_kept), (4, 3));
}

#[test]
fn a_joint_election_keeps_nothing_where_false_edges_pull_every_residual_beyond_its_quantile() {
    // This is a property of RRR, which tests all clusters together. One after the other, the true ones come first.
    let values = [0.1, -0.1, 0.2, 40.0, 40.1, 0.0, -0.2];
    let clusters = [vec![0, 1], vec![2], vec![3, 4], vec![5, 6]];
    assert!(vote(&clusters, quantiles(), Election::Joint, &fit_of_means(&values)).kept.is_empty());
    let one_by_one = vote(&clusters, quantiles(), Election::LargestFirst, &fit_of_means(&values));
    assert_eq!(one_by_one.kept, [0, 1, 2, 5, 6]);
    // One optimisation for each cluster alone and one in the election, where no group had several clusters.
    assert_eq!(one_by_one.fits, 2 * clusters.len());
}

#[test]
fn clusters_stand_in_groups_that_grow_with_success_and_none_is_refused_with_its_group() {
    // 100 clusters of one edge: the first 40 are all true, and after them every third is false.
    let values: Vec<f64> = (0..100).map(|edge| if edge > 40 && edge % 3 == 0 { 30.0 } else { 0.0 }).collect();
    let clusters: Vec<Vec<usize>> = (0..100).map(|edge| vec![edge]).collect();
    let verdict = vote(&clusters, quantiles(), Election::LargestFirst, &fit_of_means(&values));
    let expected: Vec<usize> = (0..100).filter(|&edge| values[edge] == 0.0).collect();
    assert_eq!(verdict.kept, expected);
    // One optimisation for each cluster alone and one for each in the election would be 200.
    assert!(verdict.fits < 200, "{}", verdict.fits);
    let all_true = vote(&clusters, quantiles(), Election::LargestFirst, &fit_of_means(&[0.0; 100]));
    assert_eq!(all_true.kept.len(), 100);
    // Groups grow by a quarter: 4 clusters alone, then ln(100 / 4) / ln(1.25) groups, and some more because sizes round
    // down.
    assert!(all_true.fits < 100 + 25, "{}", all_true.fits);
}

#[test]
fn the_largest_cluster_speaks_first_and_among_equals_the_first_in_the_graph() {
    let kept = |clusters: &[Vec<usize>], values: &[f64]| {
        vote(clusters, quantiles(), Election::LargestFirst, &fit_of_means(values)).kept
    };
    // This is the basis of the method: the larger cluster is believed, wherever it comes and whatever it measures.
    assert_eq!(kept(&[vec![0], vec![1, 2]], &[0.0, 40.0, 40.0]), [1, 2]);
    assert_eq!(kept(&[vec![0, 1], vec![2]], &[40.0, 40.0, 0.0]), [0, 1]);
    assert_eq!(kept(&[vec![0], vec![1], vec![2]], &[0.0, 40.0, 0.1]), [0, 2]);
}

#[test]
fn a_bad_edge_leaves_a_good_cluster_and_one_that_contradicts_itself_shrinks_until_it_does_not() {
    let kept = |values: &[f64]| {
        vote(&[(0..values.len()).collect()], quantiles(), Election::Joint, &fit_of_means(values)).kept
    };
    // One of five edges is off by 7: chi-square of the five is 118, above 26.2; without that edge it is zero.
    assert_eq!(kept(&[0.0, 0.0, 7.0, 0.0, 0.0]), [0, 1, 3, 4]);
    // Off by 2.4: chi-square 13.8 passes as a whole, and the edge's own 11.06 is below 11.34. Off by 2.6: 12.98 fails for
    // the edge alone.
    assert_eq!(kept(&[0.0, 0.0, 0.0, 0.0, 2.4]).len(), 5);
    assert_eq!(kept(&[0.0, 0.0, 0.0, 0.0, 2.6]).len(), 4);
    assert_eq!(kept(&[0.0, 50.0, 100.0, 200.0]).len(), 1);
}

#[test]
fn nothing_to_vote_on_is_no_error() {
    assert!(vote(&[], quantiles(), Election::Joint, &fit_of_means(&[])).kept.is_empty());
    assert!(Quantiles::new(1.0, 3).is_err());
}

proptest! {
    #[test]
    fn what_is_kept_passes_all_tests_together(
        values in proptest::collection::vec(prop_oneof![3 => -0.5_f64..0.5, 1 => -60.0_f64..60.0], 1..30),
        size in 1_usize..5,
        election in prop_oneof![Just(Election::LargestFirst), Just(Election::Joint)],
    ) {
        let clusters: Vec<Vec<usize>> =
            (0..values.len()).collect::<Vec<_>>().chunks(size).map(<[usize]>::to_vec).collect();
        let fit = fit_of_means(&values);
        let verdict = vote(&clusters, quantiles(), election, &fit);
        let joint = fit(&verdict.kept);
        // The quantile of chi-square at 0.99 is below three times the degrees plus nine.
        prop_assert!(joint.chi_square <= 3.0 * joint.redundancy as f64 + 9.0, "{joint:?}");
        // The order of the clusters decides, not chance.
        prop_assert_eq!(verdict, vote(&clusters, quantiles(), election, &fit));
    }
}

/// A square walked twice, with a true landmark edge at every corner of the second round and a false one.
fn square() -> PoseGraph {
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for id in 0..8 {
        text += &format!("{{\"kind\":\"node\",\"id\":{id},\"session\":\"a\",\"frame\":{}}}\n", 10 * id);
    }
    for id in 0..7 {
        text += &format!(
            "{{\"kind\":\"odometry\",\"id\":{id},\"from\":{id},\"to\":{},\"measurement\":[1,0,1.5707963267948966],\"information\":[100,0,0,100,0,400]}}\n",
            id + 1
        );
    }
    for (id, from, to, x) in [(7, 0, 4, 0.05), (8, 1, 5, -0.05), (9, 2, 6, 0.0), (10, 3, 5, 9.0)] {
        text += &format!(
            "{{\"kind\":\"landmark\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[{x},0,0],\"information\":[100,0,0,100,0,400]}}\n"
        );
    }
    PoseGraph::read("square", text.as_bytes()).unwrap()
}

#[test]
fn redundancy_counts_what_the_edges_say_beyond_the_poses() {
    let parts = Parts::<SE2, 3>::of(&square()).unwrap();
    let chain = parts.fit(&[]);
    assert_eq!(chain.redundancy, 0);
    assert!(chain.chi_square < 1e-12, "a chain can be satisfied: {}", chain.chi_square);
    assert_eq!(parts.fit(&[0, 1]).redundancy, 6);
    let one = parts.fit(&[3]);
    assert!(one.chi_square > 100.0 && one.residuals.len() == 1, "{one:?}");
}

/// A noisy walk that turns by `turn` at each step, with more odometry edges across it. Some odometry edges are stored
/// backwards.
fn walk(
    steps: usize,
    turn: f64,
    noise: &[f64],
    across: &[(usize, usize)],
    landmarks: &[(usize, usize, f64)],
) -> PoseGraph {
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    let step = SE2::new(1.0, 0.0, turn);
    let mut truth = vec![SE2::identity()];
    for _ in 0..steps {
        truth.push(truth[truth.len() - 1].compose(&step));
    }
    for id in 0..=steps {
        text += &format!("{{\"kind\":\"node\",\"id\":{id},\"session\":\"a\",\"frame\":{id}}}\n");
    }
    let mut id = 0;
    let mut add = |kind: &str, from: usize, to: usize, error: f64| {
        let measured = truth[from].between(&truth[to]).compose(&SE2::new(error, -0.3 * error, 0.1 * error));
        let [x, y, _] = measured.translation();
        text += &format!(
            "{{\"kind\":\"{kind}\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[{x},{y},{}],\"information\":[100,0,0,50,0,900]}}\n",
            measured.angle()
        );
        id += 1;
    };
    for from in 0..steps {
        let error = noise[from % noise.len()];
        if from % 7 == 3 {
            add("odometry", from + 1, from, error);
        } else {
            add("odometry", from, from + 1, error);
        }
    }
    for &(from, to) in across.iter().filter(|(from, to)| from % (steps + 1) != to % (steps + 1)) {
        add("odometry", from % (steps + 1), to % (steps + 1), 0.05);
    }
    for &(from, to, error) in landmarks.iter().filter(|(from, to, _)| from % (steps + 1) != to % (steps + 1))
    {
        add("landmark", from % (steps + 1), to % (steps + 1), error);
    }
    PoseGraph::read("walk", text.as_bytes()).unwrap()
}

proptest! {
    #[test]
    fn eliminating_nodes_of_odometry_changes_no_optimum(
        steps in 2_usize..60,
        turn in -0.4_f64..0.4,
        noise in proptest::collection::vec(-0.1_f64..0.1, 1..20),
        across in proptest::collection::vec((0_usize..100, 0_usize..100), 0..3),
        landmarks in proptest::collection::vec((0_usize..100, 0_usize..100, -1.5_f64..1.5), 1..8),
    ) {
        let mut parts = Parts::<SE2, 3>::of(&walk(steps, turn, &noise, &across, &landmarks)).unwrap();
        // Both ways reach the optimum; with four steps, each would stop somewhere before it.
        parts.steps = 200;
        let all: Vec<usize> = (0..parts.places.len()).collect();
        let (fast, whole) = (parts.fit(&all), parts.fit_whole(&all));
        prop_assert_eq!(fast.redundancy, whole.redundancy);
        let slack = 1e-2 * (1.0 + fast.chi_square.max(whole.chi_square));
        prop_assert!((fast.chi_square - whole.chi_square).abs() <= slack, "chi_square {} and {}", fast.chi_square, whole.chi_square);
        // Poses that cost the promised thousandth more than the optimum move no residual, in standard deviations, by more than
        // the root of that.
        let moved = (1e-3 * (1.0 + fast.chi_square.max(whole.chi_square))).sqrt();
        for (a, b) in fast.residuals.iter().zip(&whole.residuals) {
            prop_assert!((a.sqrt() - b.sqrt()).abs() <= moved, "{:?} and {:?}", fast.residuals, whole.residuals);
        }
    }
}

proptest! {
    #[test]
    fn an_optimum_from_that_over_fewer_edges_is_the_same_and_forecasts_foresee_it(
        steps in 10_usize..60,
        turn in -0.4_f64..0.4,
        noise in proptest::collection::vec(-0.02_f64..0.02, 1..20),
        landmarks in proptest::collection::vec((0_usize..100, 0_usize..100, -0.1_f64..0.1), 3..8),
    ) {
        let mut parts = Parts::<SE2, 3>::of(&walk(steps, turn, &noise, &[], &landmarks)).unwrap();
        parts.steps = 200;
        let all: Vec<usize> = (0..parts.places.len()).collect();
        prop_assume!(all.len() > 1);
        let (last, accepted) = all.split_last().unwrap();
        let (before, state) = Optimiser::refit(&parts, &Optimiser::state(&parts, &all), accepted);
        let (after, _) = Optimiser::refit(&parts, &state, &all);
        let cold = parts.fit(&all);
        prop_assert_eq!(after.redundancy, cold.redundancy);
        let slack = 1e-2 * (1.0 + cold.chi_square);
        prop_assert!((after.chi_square - cold.chi_square).abs() <= slack, "chi_square {} and {}", after.chi_square, cold.chi_square);
        let forecast = Optimiser::forecast(&parts, &state, accepted, &[*last])[0].unwrap();
        let increase = after.chi_square - before.chi_square;
        // The forecast is of first order: errors here are small, and the remaining difference is their square.
        prop_assert!(
            (forecast.increase - increase).abs() <= slack + 0.1 * increase,
            "chi_square grows by {} and not by {}", increase, forecast.increase
        );
        let residual = after.residuals[accepted.len()];
        prop_assert!(
            (forecast.residual - residual).abs() <= slack + 0.1 * residual,
            "a residual of {} and not of {}", residual, forecast.residual
        );
    }
}

#[test]
fn what_forecasts_refuse_an_optimisation_would_refuse() {
    // A walk there and back, with thirty true edges and, after them, ten false ones.
    let mut landmarks: Vec<_> = (0..30).map(|at| (at, 60 - at, 0.0)).collect();
    landmarks.extend((0..10).map(|at| (at, 60 - at, 1.5)));
    let graph = walk(60, std::f64::consts::PI / 30.0, &[0.01, -0.01], &[], &landmarks);
    let parts = Parts::<SE2, 3>::of(&graph).unwrap();
    let clusters: Vec<Vec<usize>> = (0..landmarks.len()).map(|edge| vec![edge]).collect();
    let foreseen = vote(&clusters, quantiles(), Election::LargestFirst, &parts);
    let optimised = vote(&clusters, quantiles(), Election::LargestFirst, &|edges: &[usize]| parts.fit(edges));
    assert_eq!(foreseen.kept, (0..30).collect::<Vec<_>>());
    assert_eq!(foreseen.kept, optimised.kept);
    assert_eq!((foreseen.foreseen, optimised.foreseen), (2, 0), "{} clusters", foreseen.clusters_consistent);
}

#[test]
fn a_false_landmark_edge_of_a_square_is_voted_out() {
    let parts = Parts::<SE2, 3>::of(&square()).unwrap();
    for election in [Election::LargestFirst, Election::Joint] {
        let clusters = [vec![0], vec![1], vec![2], vec![3]];
        let verdict = vote(&clusters, quantiles(), election, &|edges: &[usize]| parts.fit(edges));
        assert_eq!(verdict.kept, [0, 1, 2], "{election:?}");
    }
}

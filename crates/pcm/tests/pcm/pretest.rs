//! The pre-test never rejects a pair that passes the full test, and tiles give the same graph as single pairs.

use posecut_geometry::{LieGroup as _, SE2, SE3};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::consistency::Pairs;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_pcm::pretest::Verdict;
use posecut_pcm::{Gate, Spatial, Test};
use proptest::prelude::*;

fn falsehood() -> impl Strategy<Value = Falsehood> {
    prop_oneof![Just(Falsehood::Uniform), Just(Falsehood::Grouped), Just(Falsehood::NearMiss)]
}

/// The same candidates within one chain: an edge of odometry joins the end of one session to the start of the other.
fn joined(mut graph: PoseGraph) -> PoseGraph {
    let half = graph.nodes.len() as u64 / 2;
    let last = graph.edges.iter().map(|edge| edge.id).max().unwrap();
    let mut bridge = graph.edges.iter().find(|edge| edge.kind == EdgeKind::Odometry).unwrap().clone();
    (bridge.id, bridge.from, bridge.to) = (last + 1, half - 1, half);
    graph.edges.push(bridge);
    graph
}

fn holds<G: Spatial<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    probability: f64,
) -> Result<(), TestCaseError> {
    let chains = Chains::<G, DOF>::of(graph).unwrap();
    let grouped = group(graph, &chains).unwrap();
    prop_assert_eq!(grouped.groups.len(), 1);
    let pairs = Pairs::new(&chains, &grouped.groups[0]);
    let gate = Gate::new(Test::Mahalanobis, probability, DOF).unwrap();
    let limit = gate.squared_distance;
    let (matrix, counts) = pairs.graph(gate);
    let (mut open, mut consistent) = (0, 0);
    for one in 0..pairs.len() {
        for other in one + 1..pairs.len() {
            let distance = pairs.squared_distance(one, other);
            let passes = distance.is_some_and(|distance| distance <= limit);
            let verdict = pairs.pretest(one, other, limit);
            prop_assert!(
                verdict == Verdict::Open || !passes,
                "{one}, {other}: {verdict:?} rejects a squared distance of {distance:?}, gate {limit}"
            );
            prop_assert_eq!(matrix.connected(one, other), passes);
            prop_assert_eq!(matrix.connected(other, one), passes);
            open += usize::from(verdict == Verdict::Open);
            consistent += usize::from(passes);
        }
    }
    prop_assert_eq!(counts.pairs, pairs.len() * (pairs.len() - 1) / 2);
    prop_assert_eq!(counts.pairs - counts.skipped_by_rotation - counts.skipped_by_translation, open);
    prop_assert_eq!(counts.consistent, consistent);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn what_the_full_test_passes_the_pretest_leaves_open(
        seed in 0_u64..1000, outliers in 0.0_f64..1.0, falsehood in falsehood(), probability in 0.5_f64..0.9999,
    ) {
        let scenario = Scenario { candidates: 90, outliers, falsehood, seed };
        holds::<SE2, 3>(&scenario.draw::<SE2, 3>(), probability)?;
        holds::<SE3, 6>(&scenario.draw::<SE3, 6>(), probability)?;
        holds::<SE2, 3>(&joined(scenario.draw::<SE2, 3>()), probability)?;
        holds::<SE3, 6>(&joined(scenario.draw::<SE3, 6>()), probability)?;
    }
}

/// The share of inconsistent pairs that need no full test.
fn skipped<G: Spatial<DOF>, const DOF: usize>(scenario: &Scenario) -> f64 {
    let graph = scenario.draw::<G, DOF>();
    let chains = Chains::<G, DOF>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let gate = Gate::new(Test::Mahalanobis, 0.99, DOF).unwrap();
    let (_, counts) = Pairs::new(&chains, &grouped.groups[0]).graph(gate);
    let skipped = counts.skipped_by_rotation + counts.skipped_by_translation;
    skipped as f64 / (counts.pairs - counts.consistent) as f64
}

#[test]
fn it_skips_most_pairs_that_are_no_consistent_ones() {
    let scenario = Scenario { candidates: 400, outliers: 0.5, falsehood: Falsehood::Uniform, seed: 3 };
    let (plane, space) = (skipped::<SE2, 3>(&scenario), skipped::<SE3, 6>(&scenario));
    assert!(plane > 0.8 && space > 0.8, "{plane} {space}");
}

#[test]
fn the_threshold_test_needs_no_covariances() {
    let scenario = Scenario { candidates: 60, outliers: 0.3, falsehood: Falsehood::Uniform, seed: 5 };
    let graph = scenario.draw::<SE2, 3>();
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let found = &grouped.groups[0];
    let pairs = Pairs::new(&chains, found);
    let gate = Gate::per_step(0.05, 0.02);
    let (matrix, _) = pairs.graph(gate);
    let mut consistent = 0;
    for (one, a) in found.candidates.iter().enumerate() {
        for (other, b) in found.candidates.iter().enumerate().skip(one + 1) {
            // Errors per step: the loop in the frame of the first candidate's position in chain B.
            let at = chains.chains[found.b].poses[a.k];
            let error = at.inverse().compose(&a.alignment.between(&b.alignment)).compose(&at);
            let steps = (a.i.abs_diff(b.i) + a.k.abs_diff(b.k) + 2) as f64;
            let passes = error.translation.norm() <= 0.05 * steps && error.rotation_angle() <= 0.02 * steps;
            assert_eq!(matrix.connected(one, other), passes, "{one} {other}");
            consistent += usize::from(passes);
        }
    }
    assert!(consistent > 100, "{consistent}");
}

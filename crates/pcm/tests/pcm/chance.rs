//! Agreement by chance: the false alarms of random edges, and the edges that the test drops.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use posecut_geometry::{SE2, SE3};
use posecut_graph::{Edge, EdgeKind, Node, PoseGraph};
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::chance::{COST, Chance, acceptable};
use posecut_pcm::clique::{Limits, maximum_clique};
use posecut_pcm::consistency::Pairs;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_pcm::{Gate, Spatial, Test};
use proptest::prelude::*;

/// The false alarms of random edges whose only witnesses are correct edges spread over the whole route.
fn of_random_edges<G: Spatial<DOF>, const DOF: usize>(seed: u64) -> Vec<f64> {
    let scenario = Scenario { candidates: 4000, outliers: 0.9, falsehood: Falsehood::Uniform, seed };
    let graph = scenario.draw::<G, DOF>();
    let chains = Chains::<G, DOF>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let candidates = &grouped.groups[0].candidates;
    let pairs = Pairs::new(&chains, &grouped.groups[0]);
    let chance = Chance::new(&pairs);
    let correct = |candidate: usize| graph.edges[candidates[candidate].edge].truth_correct() == Some(true);
    let witnesses: Vec<usize> =
        (0..pairs.len()).filter(|&candidate| correct(candidate)).step_by(10).collect();
    (0..pairs.len())
        .filter(|&candidate| !correct(candidate))
        .map(|candidate| chance.false_alarms(candidate, &witnesses))
        .collect()
}

#[test]
fn random_edges_cause_the_false_alarms_that_are_expected() {
    for seed in 1..=5 {
        let alarms = of_random_edges::<SE2, 3>(seed);
        // Nine in ten of 4000 candidates are random, so 0.9 x of them are expected within x. Positions along a route are
        // not Gaussian, hence a factor of two.
        for within in [40.0, 100.0, 400.0] {
            let found = alarms.iter().filter(|&&expected| expected <= within).count() as f64;
            let ratio = found / (0.9 * within);
            assert!((0.5..2.0).contains(&ratio), "seed {seed}: {found} within {within}");
        }
    }
}

#[test]
fn in_space_random_edges_cause_no_more_false_alarms_than_expected() {
    for seed in 1..=5 {
        let alarms = of_random_edges::<SE3, 6>(seed);
        for within in [40.0, 100.0, 400.0, 1000.0] {
            let found = alarms.iter().filter(|&&expected| expected <= within).count() as f64;
            assert!(found <= 0.9 * within, "seed {seed}: {found} within {within}");
        }
        assert!(alarms.iter().any(|&expected| expected < 1000.0), "the test would pass without any");
    }
}

/// A random scenario without its correct edges from the positions that are left out.
fn without(scenario: Scenario, left_out: impl Fn(usize) -> bool) -> PoseGraph {
    let mut graph = scenario.draw::<SE2, 3>();
    graph.edges.retain(|edge| edge.truth_correct() != Some(true) || !left_out(edge.from as usize));
    graph
}

/// The frame of chain B is that of its first node. A stretch of odometry before this node moves the frame and changes
/// nothing else.
#[test]
fn false_alarms_do_not_depend_on_where_a_chain_begins() {
    let mut graph =
        Scenario { candidates: 150, outliers: 0.5, falsehood: Falsehood::Uniform, seed: 4 }.draw::<SE2, 3>();
    let alarms = |graph: &PoseGraph| -> Vec<f64> {
        let chains = Chains::<SE2, 3>::of(graph).unwrap();
        let grouped = group(graph, &chains).unwrap();
        let pairs = Pairs::new(&chains, &grouped.groups[0]);
        let chance = Chance::new(&pairs);
        (0..pairs.len()).map(|candidate| chance.false_alarms(candidate, &[0, 40, 80, 120])).collect()
    };
    let before = alarms(&graph);
    let (first, node) = (graph.nodes.len() as u64 / 2, graph.nodes.len() as u64);
    graph.nodes.push(Node { id: node, session: Some("b".to_owned()), ..Node::default() });
    let mut stretch = Edge::new(EdgeKind::Odometry, 10_000, node, first);
    stretch.measurement = Some(vec![700.0, -300.0, 2.0]);
    stretch.noise = Some("odometry".to_owned());
    graph.edges.push(stretch);
    for (moved, alarm) in alarms(&graph).into_iter().zip(before) {
        assert!((moved - alarm).abs() <= 1e-6 * alarm, "{moved} {alarm}");
    }
}

/// The numbers of kept and of wrong edges, before and after the test, in a scenario with positions left out.
fn with_and_without(
    scenario: Scenario,
    left_out: impl Fn(usize) -> bool,
) -> ((usize, usize), (usize, usize)) {
    let graph = without(scenario, left_out);
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let candidates = &grouped.groups[0].candidates;
    let pairs = Pairs::new(&chains, &grouped.groups[0]);
    let (consistency, _) = pairs.graph(Gate::new(Test::Mahalanobis, 0.99, 3).unwrap());
    let members = maximum_clique(&consistency, Limits::NONE).vertices;
    let support = Chance::new(&pairs).support(&members, COST);
    let mut both = [&support.supported[..], &support.by_chance[..]].concat();
    both.sort_unstable();
    assert_eq!(both, members, "every member is one or the other");
    let judged = |kept: &[usize]| {
        let correct = |&&candidate: &&usize| is_correct(&graph, candidates[candidate].edge);
        (kept.len(), kept.len() - kept.iter().filter(correct).count())
    };
    (judged(&members), judged(&support.supported))
}

fn is_correct(graph: &PoseGraph, edge: usize) -> bool {
    graph.edges[edge].truth_correct() == Some(true)
}

#[test]
fn a_random_edge_that_only_long_odometry_vouches_for_is_dropped() {
    let (mut wrong_before, mut wrong_after, mut lost) = (0, 0, 0);
    for seed in 1..=60 {
        let scenario = Scenario { candidates: 3000, outliers: 0.9, falsehood: Falsehood::Uniform, seed };
        // Correct edges lie only along the first fifth of the route; the rest is long odometry.
        let (before, after) = with_and_without(scenario, |place| place > 150);
        wrong_before += before.1;
        wrong_after += after.1;
        lost += (before.0 - before.1) - (after.0 - after.1);
    }
    println!("{wrong_before} wrong edges of 60 cliques, {wrong_after} left; {lost} correct ones lost");
    assert!(wrong_before >= 20, "the scenario has nothing to drop: {wrong_before}");
    // One run in four may keep a wrong edge: 15 are expected, from random edges that enter a clique by luck.
    assert!(wrong_after <= 20 && lost <= 6, "{wrong_after} of {wrong_before}, {lost} lost");
}

#[test]
fn two_overlaps_far_apart_both_stay() {
    for seed in 1..=10 {
        let scenario = Scenario { candidates: 2000, outliers: 0.5, falsehood: Falsehood::Uniform, seed };
        let (before, after) = with_and_without(scenario, |place| (60..440).contains(&place));
        assert_eq!(before.0 - before.1, after.0 - after.1, "seed {seed}: correct edges are lost");
    }
}

/// A candidate that is alone in its group has no witness, and nothing disagrees with it either.
#[test]
fn a_lone_candidate_stays() {
    let graph =
        Scenario { candidates: 1, outliers: 0.0, falsehood: Falsehood::Uniform, seed: 1 }.draw::<SE2, 3>();
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let pairs = Pairs::new(&chains, &grouped.groups[0]);
    let support = Chance::new(&pairs).support(&[0], COST);
    assert_eq!((support.supported, support.false_alarms), (vec![0], vec![(0, 1.0)]));
}

#[test]
fn nothing_is_supported_by_nothing() {
    let graph =
        Scenario { candidates: 5, outliers: 0.0, falsehood: Falsehood::Uniform, seed: 1 }.draw::<SE2, 3>();
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let support = Chance::new(&Pairs::new(&chains, &grouped.groups[0])).support(&[], COST);
    assert!(support.supported.is_empty() && support.by_chance.is_empty());
}

/// A separate folder for a test, with a graph as `graph.jsonl`.
fn folder(test: &str, graph: &PoseGraph) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    fs::create_dir_all(&folder).unwrap();
    let mut bytes = Vec::new();
    graph.write(&mut bytes).unwrap();
    fs::write(folder.join("graph.jsonl"), bytes).unwrap();
    folder
}

/// Runs the program on the graph of a folder.
fn pcm(folder: &Path, options: &[&str]) -> Output {
    let input = folder.join("graph.jsonl");
    Command::new(env!("CARGO_BIN_EXE_posecut-pcm")).args(options).arg(input).output().unwrap()
}

/// The graph and the statistics that the program writes.
fn run(folder: &Path, options: &[&str]) -> (PoseGraph, serde_json::Value) {
    let stats = folder.join("stats.json");
    let output = pcm(folder, &[options, &["--stats", stats.to_str().unwrap()]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let stats = serde_json::from_slice(&fs::read(stats).unwrap()).unwrap();
    (PoseGraph::read("output", &output.stdout[..]).unwrap(), stats)
}

#[test]
fn the_stage_drops_chance_agreement_only_when_asked_and_tells_the_evidence() {
    let scenario = Scenario { candidates: 3000, outliers: 0.9, falsehood: Falsehood::Uniform, seed: 11 };
    let graph = without(scenario, |place| place > 150);
    let folder = folder("chance", &graph);
    let (plain, stats) = run(&folder, &[]);
    assert_eq!(stats["agree_by_chance"], 0);
    let field = |edge: &Edge, name: &str| edge.extra.get(name).cloned();
    assert!(plain.edges.iter().all(|edge| field(edge, "pcm_false_alarms").is_none()));
    let (judged, stats) = run(&folder, &["--chance", "3"]);
    let mut dropped = 0;
    for (edge, before) in judged.edges_of(EdgeKind::Landmark).zip(plain.edges_of(EdgeKind::Landmark)) {
        let evidence = field(edge, "pcm_false_alarms").and_then(|value| value.as_f64());
        assert_eq!(evidence.is_some(), before.in_use(), "members of the clique have it, and nothing else");
        if before.in_use() && !edge.in_use() {
            dropped += 1;
            assert_eq!(field(edge, "pcm_role").unwrap(), "chance");
            assert_eq!(edge.truth_correct(), Some(false));
            assert!(evidence.unwrap() > 1.0 / (1.0 + COST));
        } else {
            assert_eq!(edge.rejected_by, before.rejected_by);
        }
    }
    assert!(dropped > 0, "nothing agrees by chance here");
    assert_eq!(stats["agree_by_chance"], dropped);
}

/// Removes the odometry edge to every `length`-th node, so that every stretch is a chain of its own.
fn with_gaps(mut graph: PoseGraph, length: u64) -> PoseGraph {
    graph.edges.retain(|edge| edge.kind != EdgeKind::Odometry || edge.to % length != 0);
    graph
}

#[test]
fn false_edges_spread_over_many_groups_are_no_evidence_each_by_itself() {
    let scenario = Scenario { candidates: 400, outliers: 0.3, falsehood: Falsehood::Uniform, seed: 5 };
    let graph = with_gaps(scenario.draw::<SE2, 3>(), 20);
    let folder = folder("gaps", &graph);
    let count = |graph: &PoseGraph, correct: bool| {
        let kept = graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.in_use());
        kept.filter(|edge| edge.truth_correct() == Some(correct)).count()
    };
    let (plain, stats) = run(&folder, &[]);
    assert!(stats["groups"].as_u64().unwrap() > 50, "{stats}");
    // By its definition PCM keeps one edge of every group.
    assert!(count(&plain, false) > 50, "{}", count(&plain, false));
    let (judged, _) = run(&folder, &["--chance", "3"]);
    assert!(count(&judged, false) <= 3, "{}", count(&judged, false));
    assert!(count(&judged, true) * 100 >= count(&plain, true) * 97, "{}", count(&judged, true));
}

#[test]
fn costs_that_mean_nothing_are_refused() {
    let graph =
        Scenario { candidates: 5, outliers: 0.0, falsehood: Falsehood::Uniform, seed: 1 }.draw::<SE2, 3>();
    let folder = folder("costs", &graph);
    for (options, reason) in [
        (&["--chance", "0"][..], "must be a positive number"),
        (&["--chance", "nan"], "must be a positive number"),
        (&["--chance", "inf"], "must be a positive number"),
        (&["--chance", "10", "--test", "threshold"], "reads no covariances"),
    ] {
        let output = pcm(&folder, options);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && message.contains(reason), "{message}");
    }
}

proptest! {
    /// No other number of edges, taken by ascending false alarms, has a greater gain.
    #[test]
    fn what_is_acceptable_is_worth_most(
        mut alarms in proptest::collection::vec(0.0_f64..5.0, 0..40),
        cost in 0.1_f64..20.0,
    ) {
        let limit = acceptable(alarms.clone(), cost);
        let worth = |limit: f64| {
            let within: Vec<f64> = alarms.iter().copied().filter(|&alarm| alarm <= limit).collect();
            within.len() as f64 - (1.0 + cost) * within.iter().copied().fold(0.0, f64::max)
        };
        let chosen = worth(limit);
        for &other in &alarms {
            prop_assert!(chosen >= worth(other) - 1e-9);
        }
        prop_assert!(chosen >= 0.0);
        alarms.reverse();
        prop_assert_eq!(limit, acceptable(alarms, cost), "the order does not matter");
    }
}

//! Simulated logs, whose true poses are known.

use posecut_carmen::{Log, LogOptions, Session};
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::PoseGraph;
use posecut_recognize::recognition::{Candidate, Recognition, recognize};
use posecut_recognize::{Settings, Words};
use posecut_scan::{LaserScan, Scans};
use posecut_simulate_log::{Options, simulate};

fn session(seed: u64, length: f64) -> PoseGraph {
    let options = Options { seed, length, ..Options::DEFAULT };
    let mut bytes = Vec::new();
    simulate(&options).write_log(&options, &mut bytes).unwrap();
    let options = LogOptions { scan_matching: true, ..LogOptions::DEFAULT };
    let log = Log::read("simulated", &bytes[..], &options).unwrap();
    let mut session = Session::of_log("simulated", "a", &log, &options).unwrap();
    session.put_scans_into_graph().unwrap();
    session.graph
}

fn found(graph: &PoseGraph, settings: &Settings) -> Recognition {
    recognize(graph, &Scans::of_graph(graph).unwrap(), None, settings).unwrap()
}

/// Whether the measurement of a candidate is near the true motion.
fn correct(graph: &PoseGraph, candidate: &Candidate) -> bool {
    let truth = |node: usize| {
        SE2::from_components(graph.nodes[node].truth.as_ref().unwrap().pose.as_ref().unwrap()).unwrap()
    };
    let motion = truth(candidate.from).between(&truth(candidate.to));
    let error = candidate.measurement.as_ref().unwrap().pose.between(&motion).log();
    error.x.hypot(error.y) < 0.3 && error.z.abs() < 0.05
}

#[test]
fn places_of_a_simulated_building_are_recognised() {
    let graph = session(1, 250.0);
    let settings = Settings { least_agreement: 0.75, ..Settings::DEFAULT };
    let all = found(&graph, &settings).candidates;
    let right = all.iter().filter(|candidate| correct(&graph, candidate)).count();
    // The corridors of the building look alike, so many are not.
    assert!(right >= 100 && right * 2 >= all.len(), "{right} of {} are correct", all.len());
    // What agrees most is right more often.
    let mean = |wanted: bool| {
        let of = all.iter().filter(|candidate| correct(&graph, candidate) == wanted);
        let (sum, count) =
            of.fold((0.0, 0.0), |(sum, count), candidate| (sum + candidate.probability(), count + 1.0));
        sum / f64::max(count, 1.0)
    };
    assert!(mean(true) > mean(false), "{} {}", mean(true), mean(false));
    for pair in all.windows(2) {
        assert!((pair[0].from, pair[0].to) < (pair[1].from, pair[1].to), "each pair once, in order");
        assert!(pair[0].from < pair[0].to);
    }
}

#[test]
fn improbable_candidates_are_left_out_and_counted() {
    let graph = session(1, 120.0);
    let settings = Settings { least_agreement: 0.75, ..Settings::DEFAULT };
    let all = found(&graph, &settings).candidates;
    let settings = Settings { least_score: 0.5, ..settings };
    let probable = found(&graph, &settings);
    let expected: Vec<Candidate> =
        all.iter().filter(|candidate| candidate.probability() >= 0.5).cloned().collect();
    assert_eq!((probable.improbable, &probable.candidates), (all.len() - expected.len(), &expected));
    assert!(!expected.is_empty() && expected.len() < all.len());
}

#[test]
fn words_from_elsewhere_need_no_scans() {
    let mut graph = session(2, 60.0);
    let count = graph.nodes.len();
    graph.unknown.clear();
    // The last keyframe sees what the first one saw, all others see words of their own.
    let bag = |node: usize| {
        if node + 1 == count { vec![0, 1, 2] } else { vec![3 * node, 3 * node + 1, 3 * node + 2] }
    };
    let words = Words::new((0..count).map(bag).collect(), 3 * count);
    let found = recognize(&graph, &Scans::default(), Some(words), &Settings::DEFAULT).unwrap();
    assert_eq!(found.candidates.len(), 1);
    let only = &found.candidates[0];
    assert_eq!((only.from, only.to, &only.measurement), (0, count - 1, &None));
    assert!(only.probability() > 0.0 && only.probability() <= 1.0);
}

#[test]
fn scans_without_returns_are_recognised_nowhere() {
    let mut graph = session(3, 40.0);
    graph.unknown = graph
        .nodes
        .iter()
        .map(|node| {
            let empty = LaserScan {
                sensor: SE2::new(0.0, 0.0, 0.0),
                first_angle: 0.0,
                angle_step: 0.1,
                ranges: vec![0.0; 30],
            };
            empty.record(node.id).unwrap()
        })
        .collect();
    assert_eq!(found(&graph, &Settings::DEFAULT), Recognition::default());
}

#[test]
fn a_robot_that_stands_still_is_recognised_nowhere() {
    let mut graph = session(4, 30.0);
    for edge in &mut graph.edges {
        edge.measurement = Some(vec![0.0; 3]);
    }
    // All keyframes are within --exclusion-length of each other, and all have the same surroundings.
    let scan = graph.unknown[0].clone();
    let number = |id: u64| scan.replace(r#""node":0"#, &format!(r#""node":{id}"#));
    graph.unknown = graph.nodes.iter().map(|node| number(node.id)).collect();
    assert_eq!(found(&graph, &Settings::DEFAULT).candidates, []);
}

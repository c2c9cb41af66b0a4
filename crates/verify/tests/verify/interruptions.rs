//! Landmark edges beyond an interruption of odometry.

use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::PoseGraph;
use posecut_verify::verdict::{Finding, Reason, Verdict};
use posecut_verify::verify;

/// Steps of one lap, and of both laps.
const LAP: usize = 60;
const STEPS: usize = 2 * LAP;
/// The step without odometry, and the only landmark edge beyond it.
const INTERRUPTED: usize = 100;
const LONE: u64 = 1000;

/// Two laps, with landmark edges between them up to the interruption, and one beyond it with an error of `error` metres.
/// After the interruption the robot goes on `carried` metres from where its odometry ended. `named` gives the fields of a
/// node that name its session and time.
fn laps(named: fn(usize) -> String, error: f64, carried: f64) -> PoseGraph {
    let mut truth = vec![SE2::identity()];
    for step in 0..STEPS {
        // Mix straights and bends, so that steps and turns differ.
        let turn = std::f64::consts::TAU / LAP as f64 * (1.0 + 0.8 * (step as f64 * 0.7).sin());
        let length = if step == INTERRUPTED { carried } else { 1.0 + 0.2 * (step as f64 * 1.3).cos() };
        truth.push(truth[step].compose(&SE2::new(length, 0.0, turn)));
    }
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for id in 0..=STEPS {
        text += &format!("{{\"kind\":\"node\",\"id\":{id}{}}}\n", named(id));
    }
    let mut add = |kind: &str, id: u64, from: usize, to: usize, error: f64| {
        let wobble = 0.01 * (id as f64 * 1.7).sin();
        let [x, y, _] = truth[from].between(&truth[to]).translation();
        let angle = truth[from].between(&truth[to]).angle();
        text += &format!(
            "{{\"kind\":\"{kind}\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[{},{},{}],\"information\":[2500,0,0,2500,0,10000]}}\n",
            x + wobble + error,
            y - wobble,
            angle + 0.3 * wobble
        );
    };
    for step in (0..STEPS).filter(|step| *step != INTERRUPTED) {
        add("odometry", step as u64, step, step + 1, 0.0);
    }
    for place in 0..INTERRUPTED - LAP {
        add("landmark", 200 + place as u64, place, place + LAP, 0.0);
    }
    add("landmark", LONE, 45, 105, error);
    PoseGraph::read("laps", text.as_bytes()).unwrap()
}

fn lone(graph: &PoseGraph) -> (Verdict, Reason) {
    let findings = verify::<SE2, 3>(graph).unwrap().findings;
    let finding = findings.iter().find(|finding| graph.edges[finding.edge].id == LONE).unwrap();
    (finding.verdict, finding.reason)
}

fn one_session(id: usize) -> String {
    format!(",\"session\":\"s\",\"frame\":{id}")
}

/// The robot lost its map and began another one a second later.
fn two_sessions(id: usize) -> String {
    format!(",\"session\":\"{}\",\"utime\":{}", if id <= INTERRUPTED { "a" } else { "b" }, 1_000_000 * id)
}

/// A second robot that started before the first one ended.
fn two_robots(id: usize) -> String {
    let (session, time) = if id <= INTERRUPTED { ("a", 10 * id) } else { ("b", 10 * id - 95) };
    format!(",\"session\":\"{session}\",\"utime\":{}", 100_000 * time)
}

fn no_session(_: usize) -> String {
    String::new()
}

#[test]
fn the_usual_motion_supports_a_lone_edge_beyond_an_interruption() {
    assert_eq!(lone(&laps(one_session, 0.0, 1.0)).0, Verdict::Accepted);
}

#[test]
fn the_usual_motion_supports_a_lone_edge_to_a_session_that_begins_where_another_ended() {
    assert_eq!(lone(&laps(two_sessions, 0.0, 1.0)).0, Verdict::Accepted);
    assert_eq!(lone(&laps(two_sessions, 60.0, 1.0)).0, Verdict::Undecided);
    assert_eq!(lone(&laps(two_robots, 0.0, 1.0)), (Verdict::Undecided, Reason::Alone));
}

/// Two or three false edges joined sessions with simulated 2012-12-01 where they do not overlap: the first and the last
/// positions of a robot that stays on roads are often near each other.
#[test]
fn an_edge_that_chance_on_roads_may_explain_joins_stretches_of_a_session_but_not_two_sessions() {
    let vague = |named| {
        let mut graph = laps(named, 0.0, 1.0);
        let edge = graph.edges.iter_mut().find(|edge| edge.id == LONE).unwrap();
        edge.information.iter_mut().flatten().for_each(|entry| *entry *= 3e-4);
        lone(&graph)
    };
    assert_eq!(vague(one_session).0, Verdict::Accepted);
    assert_eq!(vague(two_sessions), (Verdict::Undecided, Reason::Alone));
}

#[test]
fn without_sessions_and_frames_nothing_bridges_an_interruption() {
    assert_eq!(lone(&laps(no_session, 0.0, 1.0)), (Verdict::Undecided, Reason::Alone));
}

#[test]
fn a_lone_edge_that_the_usual_motion_contradicts_is_undecided() {
    assert_eq!(lone(&laps(one_session, 60.0, 1.0)).0, Verdict::Undecided);
}

#[test]
fn a_lone_edge_of_a_robot_that_was_carried_is_not_rejected() {
    assert_eq!(lone(&laps(one_session, 0.0, 60.0)).0, Verdict::Undecided);
}

/// Two sessions of two laps each, with poor odometry; the second begins where the first ended. Correct edges join them
/// halfway. False edges at the seam claim that positions twelve metres apart are the same. `start` is the time at which the
/// second begins.
fn seam(start: u64) -> PoseGraph {
    let mut truth = vec![SE2::identity()];
    for step in 0..4 * LAP {
        let turn = std::f64::consts::TAU / LAP as f64 * (1.0 + 0.8 * (step as f64 * 0.7).sin());
        truth.push(truth[step].compose(&SE2::new(1.0 + 0.2 * (step as f64 * 1.3).cos(), 0.0, turn)));
    }
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for id in 0..=4 * LAP as u64 {
        let (session, time) =
            if id <= 2 * LAP as u64 { ("a", id) } else { ("b", id + start - 2 * LAP as u64) };
        text += &format!(
            "{{\"kind\":\"node\",\"id\":{id},\"session\":\"{session}\",\"utime\":{}}}\n",
            1_000_000 * time
        );
    }
    let mut add = |kind: &str, [id, from, to]: [usize; 3], claimed: &SE2, information: &str| {
        let [x, y, _] = claimed.translation();
        let angle = claimed.angle();
        text += &format!(
            "{{\"kind\":\"{kind}\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[{x},{y},{angle}],\"information\":{information}}}\n"
        );
    };
    for step in (0..4 * LAP).filter(|step| *step != 2 * LAP) {
        let wobble = SE2::new(
            0.1 * (step as f64 * 2.1).sin(),
            0.05 * (step as f64 * 1.9).sin(),
            0.25 * (step as f64 * 1.7).sin(),
        );
        let motion = truth[step].between(&truth[step + 1]).compose(&wobble);
        add("odometry", [step, step, step + 1], &motion, "[100,0,0,400,0,400]");
    }
    for place in 0..20 {
        let (from, to) = (30 + place, 30 + place + 3 * LAP);
        let wobble = SE2::new(
            0.05 * (place as f64).sin(),
            0.05 * (place as f64 * 1.3).cos(),
            0.01 * (place as f64 * 1.1).sin(),
        );
        add(
            "landmark",
            [1000 + place, from, to],
            &truth[from].between(&truth[to]).compose(&wobble),
            "[400,0,0,400,0,10000]",
        );
    }
    for place in 0..8 {
        let wobble = SE2::new(0.05 * (place as f64).sin(), 0.05 * (place as f64 * 1.3).cos(), 0.0);
        add(
            "landmark",
            [2000 + place, 2 * LAP - 8 + place, 2 * LAP + 4 + place],
            &wobble,
            "[400,0,0,400,0,10000]",
        );
    }
    PoseGraph::read("seam", text.as_bytes()).unwrap()
}

/// Corridors of false edges at the seam of simulated 2012-03-17 and 2012-12-01 were accepted, against one correct edge there.
#[test]
fn the_usual_motion_over_a_seam_contradicts_false_edges_there() {
    let at_the_seam = |start: usize| {
        let graph = seam(start as u64);
        let findings = verify::<SE2, 3>(&graph).unwrap().findings;
        let (correct, wrong): (Vec<&Finding>, Vec<&Finding>) =
            findings.iter().partition(|finding| graph.edges[finding.edge].id < 2000);
        assert!(correct.iter().all(|finding| finding.verdict == Verdict::Accepted));
        assert!(wrong.iter().all(|finding| finding.verdict == wrong[0].verdict));
        wrong[0].verdict
    };
    assert_eq!(at_the_seam(2 * LAP), Verdict::Rejected);
    // If the second session starts much later, nothing predicts where the robot was set down.
    assert_eq!(at_the_seam(2 * LAP + 1_000_000), Verdict::Undecided);
}

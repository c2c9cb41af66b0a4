//! Odometry that is wrong over a long stretch, beyond its covariances, so that the map contradicts the edges behind it.

use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::PoseGraph;
use posecut_verify::verdict::Verdict;
use posecut_verify::{Ingredient, verify_by};

/// Steps of a session.
const STEPS: usize = 160;
/// The stretch where the last session has no landmark edges, and its wheels measure too much.
const APART: std::ops::Range<usize> = 60..90;
/// The ids of landmark edges of each pair of sessions begin at multiples of this number.
const PAIR: usize = 10_000;

/// Three sessions along one route, with landmark edges between equal positions of all of them. In the last session the wheels
/// measure `error` metres too much at each step of `APART`. Before `APART`, the edges from the second session to the last one
/// claim `other`; if it is `None`, they are missing.
fn sessions(error: f64, other: Option<SE2>) -> PoseGraph {
    let mut truth = vec![SE2::identity()];
    for step in 0..STEPS {
        let turn = 0.12 * (step as f64 * 0.11).sin();
        truth.push(truth[step].compose(&SE2::new(1.0 + 0.2 * (step as f64 * 1.3).cos(), 0.0, turn)));
    }
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    let node = |session: usize, place: usize| session * 1000 + place;
    for session in 0..3 {
        for place in 0..=STEPS {
            text += &format!(
                "{{\"kind\":\"node\",\"id\":{},\"session\":\"{session}\",\"frame\":{place}}}\n",
                node(session, place)
            );
        }
    }
    let mut add = |kind: &str, id: usize, (from, to): (usize, usize), motion: &SE2, deviation: f64| {
        let wobble = |turn: f64| 1.4 * deviation * (id as f64 * turn).sin();
        let ([x, y, _], information) = (motion.translation(), deviation.powi(-2));
        text += &format!(
            "{{\"kind\":\"{kind}\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[{},{},{}],\"information\":[{information},0,0,{information},0,{information}]}}\n",
            x + wobble(1.7),
            y + wobble(2.9),
            motion.angle() + wobble(0.9)
        );
    };
    for session in 0..3 {
        for step in 0..STEPS {
            let added = if session == 2 && APART.contains(&step) { error } else { 0.0 };
            let motion = truth[step].between(&truth[step + 1]).compose(&SE2::new(added, 0.0, 0.0));
            add(
                "odometry",
                node(session, step),
                (node(session, step), node(session, step + 1)),
                &motion,
                0.04,
            );
        }
    }
    for (pair, [a, b]) in (1..).zip([[0, 1], [0, 2], [1, 2]]) {
        for place in (0..=STEPS).step_by(2).filter(|place| b < 2 || !APART.contains(place)) {
            let ends = (node(a, place), node(b, place));
            let claim = if [a, b] == [1, 2] && place < APART.start { other } else { Some(SE2::identity()) };
            if let Some(claim) = claim {
                add("landmark", PAIR * pair + place, ends, &claim, 0.02);
            }
        }
    }
    PoseGraph::read("sessions", text.as_bytes()).unwrap()
}

/// The ids of edges that are not accepted.
fn left_out(graph: &PoseGraph, without: &[Ingredient]) -> Vec<usize> {
    let verification = verify_by::<SE2, 3>(graph, 0, without).unwrap();
    assert!(verification.broken.is_empty());
    let left_out = verification.findings.iter().filter(|finding| finding.verdict != Verdict::Accepted);
    left_out.map(|finding| graph.edges[finding.edge].id as usize).collect()
}

/// Sessions 2012-11-16 and 2013-02-23: their wheels measure 8 % too much, and all edges from their beginnings to other
/// sessions were left out.
#[test]
fn groups_that_confirm_each_other_are_accepted_against_the_odometry() {
    let graph = sessions(0.12, Some(SE2::identity()));
    assert_eq!(left_out(&graph, &[]), Vec::<usize>::new());
    assert_eq!(left_out(&graph, &[Ingredient::Trials]).len(), 60);
}

#[test]
fn a_group_that_nothing_confirms_stays_contradicted() {
    let graph = sessions(0.12, None);
    assert_eq!(left_out(&graph, &[]).len(), 30);
}

#[test]
fn groups_that_contradict_each_other_stay_contradicted() {
    let graph = sessions(0.12, Some(SE2::new(1.0, 0.0, 0.0)));
    assert_eq!(left_out(&graph, &[]).len(), 60);
}

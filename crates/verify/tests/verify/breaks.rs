//! Odometry that is broken at one or two steps.

use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::PoseGraph;
use posecut_verify::verdict::Verdict;
use posecut_verify::{Ingredient, verify_by};

/// Steps of one lap, and of all laps.
const LAP: usize = 60;
const STEPS: usize = 3 * LAP;
/// The first id of landmark edges.
const LANDMARK: usize = 1000;

/// Three laps, with landmark edges from each position of the first two to the same position one lap later. `broken` lists the
/// motions added to steps of the odometry. Edges whose later end is in `moved` claim a position 40 m away. The robot takes
/// the step `slow` at a third of its usual speed.
fn laps(broken: &[(usize, SE2)], moved: std::ops::Range<usize>, slow: Option<usize>) -> PoseGraph {
    laps_where(broken, moved, slow, |_| true)
}

/// The same with edges to these later ends only.
fn laps_where(
    broken: &[(usize, SE2)],
    moved: std::ops::Range<usize>,
    slow: Option<usize>,
    is_seen: impl Fn(usize) -> bool,
) -> PoseGraph {
    let mut truth = vec![SE2::identity()];
    for step in 0..STEPS {
        let turn = std::f64::consts::TAU / LAP as f64 * (1.0 + 0.8 * (step as f64 * 0.7).sin());
        let speed = if slow == Some(step) { 0.35 } else { 1.0 };
        let (length, slip) = (speed + 0.2 * (step as f64 * 1.3).cos(), 0.1 * (step as f64 * 2.3).sin());
        truth.push(truth[step].compose(&SE2::new(length, slip, turn)));
    }
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for id in 0..=STEPS {
        text += &format!("{{\"kind\":\"node\",\"id\":{id}}}\n");
    }
    let mut add = |kind: &str, [id, from, to]: [usize; 3], motion: &SE2| {
        let wobble = 0.01 * (id as f64 * 1.7).sin();
        let [x, y, _] = motion.translation();
        text += &format!(
            "{{\"kind\":\"{kind}\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[{},{},{}],\"information\":[2500,0,0,2500,0,10000]}}\n",
            x + wobble,
            y - wobble,
            motion.angle() + 0.3 * wobble
        );
    };
    for step in 0..STEPS {
        let motion = truth[step].between(&truth[step + 1]);
        let added = broken.iter().find(|(place, _)| *place == step);
        add("odometry", [step, step, step + 1], &added.map_or(motion, |(_, added)| motion.compose(added)));
    }
    for to in (LAP..3 * LAP).filter(|&to| is_seen(to)) {
        let from = to - LAP;
        let motion = truth[from].between(&truth[to]);
        let claimed = if moved.contains(&to) { SE2::new(40.0, 5.0, 1.0).compose(&motion) } else { motion };
        add("landmark", [LANDMARK + to, from, to], &claimed);
    }
    PoseGraph::read("laps", text.as_bytes()).unwrap()
}

/// The edges that are not accepted, by their later ends, and the broken odometry.
fn judged(graph: &PoseGraph, without: &[Ingredient]) -> (Vec<usize>, Vec<usize>) {
    let verification = verify_by::<SE2, 3>(graph, 0, without).unwrap();
    let left_out = verification.findings.iter().filter(|finding| finding.verdict != Verdict::Accepted);
    let left_out = left_out.map(|finding| graph.edges[finding.edge].id as usize - LANDMARK);
    (left_out.collect(), verification.broken)
}

fn spun() -> SE2 {
    SE2::new(1.5, -0.8, 2.0)
}

#[test]
fn edges_behind_a_broken_step_are_accepted() {
    let graph = laps(&[(150, spun())], 0..0, None);
    assert_eq!(judged(&graph, &[]), (vec![], vec![150]));
    let (left_out, broken) = judged(&graph, &[Ingredient::Breaks]);
    assert!(left_out.iter().all(|place| *place > 150) && left_out.len() >= 25, "{left_out:?}");
    assert!(broken.is_empty());
}

/// Simulated session 2012-12-01: wheels turned while the robot stood still. This is not its usual motion, but not chance either.
#[test]
fn edges_behind_a_broken_step_are_accepted_where_the_robot_was_slower_than_usual() {
    let graph = laps(&[(150, spun())], 0..0, Some(150));
    assert_eq!(judged(&graph, &[]), (vec![], vec![150]));
}

/// Session 2012-11-16: edges between two breaks and behind three more.
#[test]
fn edges_between_broken_steps_and_behind_them_are_accepted() {
    let graph = laps(&[(100, spun()), (115, spun()), (160, spun()), (170, spun())], 0..0, None);
    let (left_out, broken) = judged(&graph, &[]);
    assert!(left_out.is_empty(), "{left_out:?}");
    // More steps may be found than are broken.
    assert!([100, 115, 160, 170].iter().all(|step| broken.contains(step)), "{broken:?}");
}

#[test]
fn false_edges_that_agree_with_each_other_are_no_sign_of_a_broken_step() {
    let graph = laps(&[], 150..STEPS, None);
    let (left_out, broken) = judged(&graph, &[]);
    assert_eq!((left_out, broken), ((150..STEPS).collect(), vec![]));
}

/// Loops close before and after step 90, and no accepted one spans it. The edges that do end 10 and more steps from it.
#[test]
fn edges_on_both_sides_of_a_broken_step_are_accepted_however_far_it_is() {
    let is_seen = |to: usize| (60..75).contains(&to) || (122..138).contains(&to) || to >= 160;
    let (left_out, broken) = judged(&laps_where(&[(90, spun())], 0..0, None, is_seen), &[]);
    assert_eq!((left_out, broken), (vec![], vec![90]));
    // Without a slip, the same edges, moved, are false.
    let (left_out, broken) = judged(&laps_where(&[], 122..138, None, is_seen), &[]);
    assert_eq!((left_out, broken), ((122..138).collect(), vec![]));
}

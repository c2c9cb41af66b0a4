//! Labels by measured relations: odometry that drifts is corrected by them, and candidates have no part in that.

use posecut_evaluate::relations::{Track, relations};
use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::{Edge, EdgeKind, PoseGraph};
use posecut_label::ground_truth::{Comparison, GroundTruth, apply};

/// Half metres forwards along a line, a keyframe at every second one, at whole seconds. Odometry turns left by 0.1 rad a keyframe step.
fn drive(landmarks: &str) -> (PoseGraph, Track) {
    let mut text =
        String::from("{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n");
    let mut track = String::new();
    let mut pose = SE2::identity();
    for step in 0..21 {
        if step % 2 == 0 {
            let (id, pose) = (step / 2, pose.components());
            text += &format!(
                "{{\"kind\":\"node\",\"id\":{id},\"utime\":{},\"pose\":{pose:?}}}\n",
                step * 1_000_000
            );
        }
        let half = 0.5 * pose.angle();
        let (sine, cosine) = half.sin_cos();
        track += &format!(
            "{step} {:.9} {:.9} 0 0 0 {sine:.9} {cosine:.9}\n",
            pose.translation.x, pose.translation.y
        );
        pose = pose.compose(&SE2::new(0.5, 0.0, 0.05));
    }
    let motion = SE2::new(0.5, 0.0, 0.05).compose(&SE2::new(0.5, 0.0, 0.05)).components();
    for id in 0..10 {
        text += &format!(
            "{{\"kind\":\"odometry\",\"id\":{id},\"from\":{id},\"to\":{},\"measurement\":{motion:?},\"information\":[100,0,0,100,0,100]}}\n",
            id + 1
        );
    }
    text += landmarks;
    (PoseGraph::read("test", text.as_bytes()).unwrap(), Track::read("test.tum", track.as_bytes()).unwrap())
}

fn landmark(id: u64, to: u64, x: f64) -> String {
    format!(
        "{{\"kind\":\"landmark\",\"id\":{id},\"from\":0,\"to\":{to},\"measurement\":[{x},0,0],\"information\":[1e9,0,0,1e9,0,1e9]}}\n"
    )
}

#[test]
fn relations_correct_the_odometry_and_candidates_do_not() {
    // The true path is straight: 10 m. One candidate says so, and one, very sure, that keyframe 10 is at 4 m.
    let (mut graph, track) = drive(&(landmark(90, 10, 10.0) + &landmark(91, 10, 4.0)));
    // Between scans that are no keyframes, too: from 1 s to 19 s there are 9 m.
    let text = "0 20 10 0 0 0 0 0\n1 19 9 0 0 0 0 0\n# a comment\n0 10 5 0 0 0 0 0\n6 6 0 0 0 0 0 0\n";
    let known = relations("test.relations", text.as_bytes()).unwrap();
    let (truth, errors) = GroundTruth::of_relations("test.relations", &graph, &known, &track).unwrap();
    assert_eq!(errors.compared, 4);
    assert!(errors.translation_m.unwrap().mean < 0.1);
    let comparison =
        Comparison { tolerance_translation: 0.5, tolerance_rotation: 6.0, ..Comparison::DEFAULT };
    apply(&mut graph, &truth, &comparison).unwrap();
    let labels: Vec<_> = graph.edges_of(EdgeKind::Landmark).map(Edge::truth_correct).collect();
    assert_eq!(labels, [Some(true), Some(false)]);
    let end = graph.nodes[10].truth.as_ref().unwrap().pose.as_ref().unwrap();
    let start = graph.nodes[0].truth.as_ref().unwrap().pose.as_ref().unwrap();
    assert!(((end[0] - start[0]).hypot(end[1] - start[1]) - 10.0).abs() < 0.2, "{start:?} {end:?}");
}

#[test]
fn relations_of_another_log_are_refused() {
    let (graph, track) = drive("");
    let known = relations("test.relations", "900 910 1 0 0 0 0 0\n".as_bytes()).unwrap();
    let error = GroundTruth::of_relations("test.relations", &graph, &known, &track).unwrap_err();
    let said = format!("{error:#}");
    assert!(
        said.starts_with("test.relations: none of the 1 relations is between two different keyframes"),
        "{said}"
    );
}

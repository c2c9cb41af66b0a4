//! Errors of relative motions.

use posecut_evaluate::relations::{Track, relation_errors, relations};
use posecut_evaluate::{Options, evaluate, evaluate_with_relations};
use posecut_graph::PoseGraph;

/// Two sessions of two keyframes each: straight ahead by 1 m in 10 s, and somewhere else, later.
fn graph() -> PoseGraph {
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for (id, session, utime, x) in [
        (0, "a", 10_000_000, 0.0),
        (1, "a", 20_000_000, 1.0),
        (2, "b", 40_000_000, 50.0),
        (3, "b", 50_000_000, 52.0),
    ] {
        text += &format!(
            "{{\"kind\":\"node\",\"id\":{id},\"session\":\"{session}\",\"frame\":{id},\"utime\":{utime},\"pose\":[{x},0,0]}}\n"
        );
    }
    PoseGraph::read("graph", text.as_bytes()).unwrap()
}

#[test]
fn errors_of_relations_by_hand() {
    // Along the geodesic the robot is at 0.25 m and 0.75 m: a motion of 0.5 m.
    let known = relations("r", "# t1 t2\n12.5 17.5 0.5 0.3 0 0 0 0.1\n17.5 12.5 -0.9 0 0 0 0 0\n".as_bytes())
        .unwrap();
    let errors = relation_errors(&graph(), &known, None, 0.0);
    assert_eq!((errors.compared, errors.skipped), (2, 0));
    let (translation, rotation) = (errors.translation_m.unwrap(), errors.rotation_rad.unwrap());
    assert!(
        (translation.mean - 0.35).abs() < 1e-12 && (translation.std - 0.05).abs() < 1e-12,
        "{translation:?}"
    );
    assert!((rotation.mean - 0.05).abs() < 1e-12, "{rotation:?}");
}

#[test]
fn times_without_a_pose_are_skipped_and_sessions_are_not_bridged() {
    let known =
        relations("r", "9.8 20.3 1 0 0 0 0 0\n12 30 1 0 0 0 0 0\n60 61 1 0 0 0 0 0\n".as_bytes()).unwrap();
    let errors = relation_errors(&graph(), &known, None, 0.5);
    assert_eq!((errors.compared, errors.skipped), (1, 2));
    assert!(errors.translation_m.unwrap().max < 1e-12);
    assert_eq!(relation_errors(&graph(), &known, None, 0.1).compared, 0);
}

/// The robot waits until the last second and then drives, as only the trajectory knows. Its odometry over-reads by a factor of 2.
#[test]
fn a_trajectory_says_where_the_robot_was_between_keyframes() {
    let tum = "10 0 0 0 0 0 0 1\n19 0 0 0 0 0 0 1\n20 2 0 0 0 0 0 1\n21 3 0 0 0 0 0 1\n";
    let track = Track::read("t", tum.as_bytes()).unwrap();
    let known = relations("r", "15 19.5 0.5 0 0 0 0 0\n20 20.5 0.5 0 0 0 0 0\n".as_bytes()).unwrap();
    let errors = relation_errors(&graph(), &known, Some(&track), 0.5);
    assert_eq!((errors.compared, errors.interpolation), (2, "trajectory"));
    assert!(errors.translation_m.unwrap().max < 1e-12, "{errors:?}");
    let geodesic = relation_errors(&graph(), &known, None, 0.5).translation_m.unwrap();
    assert!(geodesic.max > 0.04, "{geodesic:?}");
}

#[test]
fn relations_alone_are_enough_for_a_result() {
    let graph = graph();
    let known = relations("r", "10 20 1 0 0 0 0 0\n".as_bytes()).unwrap();
    let errors = relation_errors(&graph, &known, None, 0.5);
    let result = evaluate_with_relations(&graph, None, Some(errors), &Options::DEFAULT).unwrap();
    assert_eq!((result.rmse, result.relations.unwrap().compared), (None, 1));
    assert!(evaluate(&graph, None, &Options::DEFAULT).is_err());
}

#[test]
fn bad_files_are_refused_with_their_line() {
    for (text, expected) in [
        ("1 2 3\n", "r, line 1: expected 8 numbers, found 3;"),
        ("\n1 2 3 4 5 6 7 x\n", "r, line 2: \"x\" is not a number;"),
        ("1 nan 0 0 0 0 0 0\n", "r, line 1: nan is not finite;"),
        ("# nothing\n", "r: has no relations;"),
    ] {
        let said = relations("r", text.as_bytes()).unwrap_err().to_string();
        assert!(said.starts_with(expected), "{said}");
    }
    let said = Track::read("t", "1 0 0 0 0 0 0 0\n".as_bytes()).unwrap_err().to_string();
    assert!(said.starts_with("t, line 1: its quaternion has the norm 0, not 1;"), "{said}");
    assert!(Track::read("t", "".as_bytes()).unwrap_err().to_string().starts_with("t: has no poses;"));
}

//! Graphs and arguments that allow no good result.

use crate::{clean, laps, only, stderr};

#[test]
fn a_graph_whose_edges_are_all_rejected_ends_with_status_3_and_is_written() {
    let folder = tempfile::tempdir().unwrap();
    // Without the correct edges, whose reports are the lines after the odometry.
    let only_wrong = only(&laps(&[(3, 18), (25, 95), (60, 7)]), |line| {
        !line.ends_with("10000") || line.contains(" 0.1 0.1 0 ")
    });
    std::fs::write(folder.path().join("map.g2o"), only_wrong).unwrap();
    let output = clean(folder.path(), &["map.g2o", "-o", "out.g2o"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("warning: 0 of 3 landmark edges accepted"), "{said}");
    assert!(folder.path().join("out.g2o").exists());
}

#[test]
fn a_graph_without_landmark_edges_is_only_optimised() {
    let folder = tempfile::tempdir().unwrap();
    let odometry = only(&laps(&[]), |line| !line.ends_with("10000"));
    std::fs::write(folder.path().join("map.g2o"), odometry).unwrap();
    let output = clean(folder.path(), &["map.g2o", "-o", "out.g2o"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("0 landmark edges"), "{}", stderr(&output));
}

#[test]
fn arguments_that_cannot_work_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.g2o"), laps(&[])).unwrap();
    std::fs::write(folder.path().join("path.tum"), "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n").unwrap();
    for (arguments, sentence) in [
        (vec!["map.g2o", "-o", "out.g2o", "--method", "none-such"], "there is no program posecut-none-such"),
        (vec!["map.g2o", "-o", "out.g2o", "--method", "none", "--explain", "3"], "need --method verify"),
        (vec!["map.g2o", "-o", "out.g2o", "--explain", "3"], "this is an odometry edge"),
        (vec!["map.g2o", "-o", "out.g2o", "--edges", "map.g2o"], "name two files"),
        (vec!["map.g2o", "-o", "out.g2o", "--edges", "out.g2o"], "name two files"),
        (vec!["map.g2o", "-o", "out.g2o", "--edges", "-"], "--edges cannot be -"),
        (vec!["map.g2o", "-o", "out.g2o", "--hypothesis", "9"], "leave --hypothesis out"),
        (vec!["path.tum", "-o", "out.tum"], "holds no edges"),
        (vec!["missing.g2o", "-o", "out.g2o"], "missing.g2o"),
    ] {
        let output = clean(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(sentence), "{arguments:?}: {}", stderr(&output));
        assert!(!folder.path().join("out.g2o").exists(), "{arguments:?}");
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("map.g2o")).unwrap(), laps(&[]));
}

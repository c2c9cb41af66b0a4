//! Reads and writes JRL datasets, as format/DATASET_FORMAT.md of github.com/DanMcGann/jrl describes them and its library writes them.

use posecut_convert::{Odometry, jrl};
use posecut_graph::{Dimension, EdgeKind, PoseGraph};
use serde_json::{Value, json};

/// The key of a robot's pose.
pub(crate) fn key(letter: char, number: u64) -> u64 {
    (u64::from(u32::from(letter)) << 56) | number
}

pub(crate) fn read_with(
    dataset: &Value,
    options: &jrl::ReadOptions,
) -> Result<(PoseGraph, jrl::ReadSummary), String> {
    jrl::read("test.jrl", dataset.to_string().as_bytes(), options).map_err(|error| error.to_string())
}

fn read(dataset: &Value) -> (PoseGraph, jrl::ReadSummary) {
    read_with(dataset, &jrl::ReadOptions::default()).unwrap()
}

fn pose(x: f64) -> Value {
    json!({"type": "Pose2", "x": x, "y": 2.0, "theta": 0.5})
}

pub(crate) fn between(from: u64, to: u64, x: f64) -> Value {
    json!({
        "type": "BetweenFactorPose2", "key1": from, "key2": to, "measurement": pose(x),
        "covariance": [0.25, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.125],
    })
}

fn value(key: u64, x: f64) -> Value {
    let mut value = pose(x);
    value["key"] = key.into();
    value
}

/// Two robots of three poses with one closure within a robot, one wrong one, and one between the robots that both have.
pub(crate) fn two_robots() -> Value {
    let [a, b] = ['a', 'b'].map(|letter| move |number| key(letter, number));
    let prior = |key| json!({"type": "PriorFactorPose2", "key": key, "prior": pose(0.0), "covariance": [1e-8, 0, 0, 0, 1e-8, 0, 0, 0, 1e-8]});
    let entry = |stamp: u64, measurements: Vec<Value>| json!({"stamp": stamp, "measurements": measurements});
    let shared = between(a(2), b(2), 7.0);
    json!({
        "name": "two robots",
        // The library writes the letters as their codes.
        "robots": [97, 98],
        "measurements": {
            "a": [
                entry(0, vec![prior(a(0))]),
                entry(1, vec![between(a(0), a(1), 1.0)]),
                entry(2, vec![between(a(1), a(2), 1.0), between(a(0), a(2), 2.0), shared.clone()]),
            ],
            "b": [
                entry(0, vec![prior(b(0))]),
                entry(1, vec![between(b(0), b(1), 1.0)]),
                entry(2, vec![between(b(1), b(2), 1.0), between(b(0), b(2), 40.0), shared]),
            ],
        },
        "groundtruth": {"a": [value(a(0), 10.0), value(a(1), 11.0)], "b": [value(b(2), 12.0)]},
        "initialization": {
            "a": [value(a(0), 0.0), value(a(1), 1.0), value(a(2), 2.0), value(b(2), 99.0)],
            "b": [value(b(0), 0.0), value(b(1), 1.0), value(b(2), 2.0)],
        },
        "potential_outlier_factors": {"a": [[2, 1], [2, 2]], "b": [[2, 1], [2, 2]]},
        "outlier_factors": {"a": [], "b": [[2, 1]]},
    })
}

fn check_close(found: &[f64], expected: &[f64]) {
    let close = found.iter().zip(expected).all(|(found, number)| (found - number).abs() < 1e-9);
    assert!(close && found.len() == expected.len(), "{found:?} is not {expected:?}");
}

#[test]
fn robots_truth_labels_and_anchor_are_read() {
    let (graph, summary) = read(&two_robots());
    assert_eq!(graph.sessions(), ["a", "b"]);
    assert_eq!(graph.header.extra["name"], "two robots");
    let frames: Vec<(u64, Option<i64>)> = graph.nodes.iter().map(|node| (node.id, node.frame)).collect();
    assert_eq!(frames[3..], [(key('b', 0), Some(0)), (key('b', 1), Some(1)), (key('b', 2), Some(2))]);
    // The value of the robot's own list counts, not the 99 of the other's.
    assert_eq!(graph.nodes[5].pose.as_deref(), Some(&[2.0, 2.0, 0.5][..]));
    let truths: Vec<Option<f64>> =
        graph.nodes.iter().map(|node| Some(node.truth.as_ref()?.pose.as_ref()?[0])).collect();
    assert_eq!(truths, [Some(10.0), Some(11.0), None, None, None, Some(12.0)]);
    // One prior anchors the graph; the other is counted.
    let fixed: Vec<bool> = graph.nodes.iter().map(|node| node.is_fixed().unwrap()).collect();
    assert_eq!(fixed, [true, false, false, false, false, false]);
    assert_eq!((summary.priors, summary.labelled, summary.without_value), (1, 3, 0));
    assert_eq!(graph.edges_of(EdgeKind::Odometry).count(), 4);
    let closures: Vec<(f64, Option<bool>)> = graph
        .edges_of(EdgeKind::Landmark)
        .map(|edge| (edge.measurement.as_ref().unwrap()[0], edge.truth_correct()))
        .collect();
    assert_eq!(closures, [(2.0, Some(true)), (7.0, Some(true)), (40.0, Some(false))]);
    let odometry = graph.edges_of(EdgeKind::Odometry).next().unwrap();
    check_close(odometry.information.as_deref().unwrap(), &[4.0, 0.0, 0.0, 2.0, 0.0, 8.0]);
}

#[test]
fn without_lists_every_other_edge_is_a_closure_without_label() {
    let mut dataset = two_robots();
    let object = dataset.as_object_mut().unwrap();
    object.remove("potential_outlier_factors");
    object.remove("outlier_factors");
    let (graph, summary) = read(&dataset);
    assert_eq!((graph.edges_of(EdgeKind::Landmark).count(), summary.labelled), (3, 0));
    let none = jrl::ReadOptions { odometry: Odometry::None, ..jrl::ReadOptions::default() };
    let (graph, _) = read_with(&dataset, &none).unwrap();
    assert_eq!(graph.edges_of(EdgeKind::Landmark).count(), 7);
}

/// The document has lists without robots, values by key and letters as text.
#[test]
fn the_documents_own_notation_is_read() {
    let [a, b, c] = [0, 1, 2].map(|number| key('a', number));
    let dataset = json!({
        "name": "one", "robots": ["a"],
        "measurements": {"a": [
            {"stamp": 1_327_194_947, "measurements": null},
            {"stamp": 1_327_194_948, "measurements": [between(a, b, 1.0)]},
            {"stamp": 1_327_194_949, "measurements": [between(b, c, 1.0), between(a, c, 9.0)]},
        ]},
        "initialization": {"a": {a.to_string(): pose(0.0), b.to_string(): pose(1.0)}},
        "potential_outlier_factors": [[2, 1]],
        "outlier_factors": [[2, 1]],
    });
    let (graph, summary) = read(&dataset);
    assert_eq!(summary.without_value, 1);
    assert_eq!(graph.edges_of(EdgeKind::Landmark).next().unwrap().truth_correct(), Some(false));
    // Stamps that can only be seconds since 1970.
    assert_eq!(graph.nodes[1].utime, Some(1_327_194_948_000_000));
}

/// gtsam's covariance of a Pose3 has the rotation first, and its quaternion the w.
#[test]
fn spatial_factors_are_reordered() {
    let variances = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
    let covariance: Vec<f64> =
        (0..36).map(|place| if place % 7 == 0 { variances[place / 7] } else { 0.0 }).collect();
    let half = 0.5_f64.sqrt();
    let dataset = json!({"name": "x", "robots": [97], "measurements": {"a": [{"stamp": 0, "measurements": [{
        "type": "BetweenFactorPose3", "key1": key('a', 0), "key2": key('a', 1), "covariance": covariance,
        "measurement": {"type": "Pose3", "translation": [1.0, 2.0, 3.0], "rotation": [half, 0.0, 0.0, half]},
    }]}]}});
    let (graph, _) = read(&dataset);
    assert_eq!(graph.header.dimension, Dimension::Three);
    let edge = &graph.edges[0];
    assert_eq!(edge.measurement.as_deref(), Some(&[1.0, 2.0, 3.0, 0.0, 0.0, half, half][..]));
    let information = edge.information.as_deref().unwrap();
    let diagonal = [0, 6, 11, 15, 18, 20].map(|place| information[place]);
    check_close(&diagonal, &[1.0 / 8.0, 1.0 / 16.0, 1.0 / 32.0, 1.0, 1.0 / 2.0, 1.0 / 4.0]);
    let (bytes, _) = jrl::write(&graph, false).unwrap();
    let written: Value = serde_json::from_slice(&bytes).unwrap();
    let factor = &written["measurements"]["a"][1]["measurements"][0];
    let written: Vec<f64> = serde_json::from_value(factor["covariance"].clone()).unwrap();
    check_close(&written, &covariance);
    assert_eq!(factor["measurement"]["rotation"], json!([half, 0.0, 0.0, half]));
}

#[test]
fn a_dataset_comes_back() {
    let (mut graph, _) = read(&two_robots());
    let (bytes, summary) = jrl::write(&graph, false).unwrap();
    assert_eq!(summary, jrl::WriteSummary::default());
    let written: Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!((&written["name"], &written["robots"]), (&json!("two robots"), &json!([97, 98])));
    assert_eq!(written["outlier_factors"], json!({"a": [], "b": [[2, 1]]}));
    let (mut again, summary) = jrl::read("again", &bytes, &jrl::ReadOptions::default()).unwrap();
    assert_eq!(summary.labelled, 3);
    // Edges are numbered in the order of the file, which is that of their entries.
    for graph in [&mut graph, &mut again] {
        graph.edges.sort_by_key(|edge| (edge.from, edge.to));
        (0..).zip(&mut graph.edges).for_each(|(id, edge)| edge.id = id);
    }
    assert_eq!(again, graph);
    // Rejected edges are left out, or kept.
    graph.edges[0].rejected_by = Some("pcm".to_owned());
    assert_eq!(jrl::write(&graph, false).unwrap().1.rejected, 1);
    assert_eq!(jrl::write(&graph, true).unwrap().1.rejected, 0);
}

/// Sessions get letters, and half a set of labels would call the other half correct.
#[test]
fn sessions_get_letters_and_incomplete_labels_are_left_out() {
    let (mut graph, _) = read(&two_robots());
    for (id, node) in (0..).zip(&mut graph.nodes) {
        let letter = node.session.take().unwrap();
        let from = std::mem::replace(&mut node.id, id);
        node.session = Some(format!("2012-01-2{}", u8::from(letter == "b")));
        for edge in &mut graph.edges {
            edge.from = if edge.from == from { id } else { edge.from };
            edge.to = if edge.to == from { id } else { edge.to };
        }
    }
    graph.edges.iter_mut().rev().find(|edge| edge.truth.is_some()).unwrap().truth = None;
    let (bytes, summary) = jrl::write(&graph, false).unwrap();
    assert_eq!(summary.renamed, [('a', "2012-01-20".to_owned()), ('b', "2012-01-21".to_owned())]);
    assert_eq!(summary.unlabelled, 1);
    let written: Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(written.get("outlier_factors"), None);
    let (again, _) = jrl::read("again", &bytes, &jrl::ReadOptions::default()).unwrap();
    assert_eq!((again.nodes.len(), again.edges.len()), (graph.nodes.len(), graph.edges.len()));
}

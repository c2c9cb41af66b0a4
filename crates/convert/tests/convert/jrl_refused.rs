//! JRL datasets that are refused: file, field, remedy.

use posecut_convert::jrl;
use posecut_graph::{EdgeKind, PoseGraph};
use serde_json::{Value, json};

use crate::jrl::{between, key, read_with, two_robots};

fn refused(dataset: &Value) -> String {
    read_with(dataset, &jrl::ReadOptions::default()).unwrap_err()
}

/// The dataset of two robots after a change.
fn changed(change: impl Fn(&mut Value)) -> Value {
    let mut dataset = two_robots();
    change(&mut dataset);
    dataset
}

#[test]
fn the_binary_form_is_refused_with_the_command_that_converts_it() {
    let said = jrl::read("x.jrl.cbor", b"\xa5dname", &jrl::ReadOptions::default()).unwrap_err().to_string();
    assert!(said.starts_with("x.jrl.cbor: the dataset is CBOR") && said.contains("cbor2.load"), "{said}");
}

#[test]
fn json_that_is_no_dataset_is_refused() {
    let said = |text: &str| {
        jrl::read("x.jrl", text.as_bytes(), &jrl::ReadOptions::default()).unwrap_err().to_string()
    };
    for (text, parts) in [
        ("{\n\"name\": \"x\",\n\"measurements\": {\"a\": [", &["x.jrl, line 3", "cut short"][..]),
        ("{\"name\": 3, \"measurements\": {}}", &["x.jrl, line 1: column", "DATASET_FORMAT.md"]),
        ("{\"dataset_name\": \"x\", \"solutions\": {}}", &["no field \"measurements\"", ".jrr"]),
        ("{\"name\": \"x\", \"measurements\": {\"a\": []}}", &["no factor and no value of a pose"]),
        ("{\"name\": \"x\", \"measurements\": {\"a\": [], \"a\": []}}", &["the field \"a\" occurs twice"]),
    ] {
        let said = said(text);
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
}

#[test]
fn fields_are_named() {
    let in_entry = |change: fn(&mut Value)| {
        changed(|dataset| change(&mut dataset["measurements"]["b"][2]["measurements"][1]))
    };
    for (dataset, parts) in [
        (
            in_entry(|factor| factor["covariance"][0] = json!(-1.0)),
            &["measurements.b[2].measurements[1]", "covariance", "at its source"][..],
        ),
        (in_entry(|factor| factor["covariance"] = json!([1.0])), &["1 numbers instead of 9"]),
        (in_entry(|factor| factor["key2"] = factor["key1"].clone()), &["joins b0 to itself"]),
        (
            in_entry(|factor| {
                factor.as_object_mut().unwrap().remove("key1");
            }),
            &["lacks a field", "key1, key2"],
        ),
        (
            in_entry(|factor| factor["measurement"] = json!({"type": "Point2", "x": 1.0, "y": 2.0})),
            &["is a Point2, not a Pose2"],
        ),
        (
            in_entry(|factor| factor["type"] = json!("RangeFactor2D")),
            &["a RangeFactor2D cannot be used", "--skip-unknown"],
        ),
        (
            in_entry(|factor| factor["type"] = json!("BetweenFactorPose3")),
            &["dimension 3 follows dimension 2"],
        ),
        (
            changed(|dataset| dataset["outlier_factors"]["b"] = json!([[2, 9]])),
            &["outlier_factors.b", "no factor [2, 9]"],
        ),
        (
            changed(|dataset| dataset["outlier_factors"] = json!([[2, 1]])),
            &["names no robot, but the dataset has 2"],
        ),
        (
            changed(|dataset| {
                let first = dataset["initialization"]["a"][0].clone();
                dataset["initialization"]["a"].as_array_mut().unwrap().push(first);
            }),
            &["initialization.a, key a0", "occurs twice"],
        ),
        (
            changed(|dataset| {
                let prior = &mut dataset["measurements"]["a"][0]["measurements"][0];
                (prior["key"], prior["covariance"]) = (json!(key('a', 1)), json!([1.0]));
            }),
            &["measurements.a[0].measurements[0]", "1 numbers instead of 9"],
        ),
    ] {
        let said = refused(&dataset);
        assert!(said.starts_with("test.jrl"), "{said}");
        for part in parts {
            assert!(said.contains(part), "lacks {part:?}: {said}");
        }
    }
}

#[test]
fn other_factors_are_skipped_on_request() {
    let dataset = changed(|dataset| {
        dataset["measurements"]["b"][2]["measurements"][1] =
            json!({"type": "RangeFactor2D", "key1": 0, "key2": 1, "measurement": 3.5, "covariance": [1.0]});
    });
    let options = jrl::ReadOptions { skip_unknown: true, ..jrl::ReadOptions::default() };
    let (graph, summary) = read_with(&dataset, &options).unwrap();
    assert_eq!(summary.skipped["RangeFactor2D"], 1);
    assert_eq!(graph.edges_of(EdgeKind::Landmark).count(), 2);
}

#[test]
fn what_a_dataset_cannot_hold_is_refused() {
    let [a, b] = [0, 1].map(|number| key('a', number));
    let dataset = json!({"name": "x", "robots": [97], "measurements": {"a": [{"stamp": 0, "measurements": [between(a, b, 1.0)]}]}});
    let (mut graph, _) = read_with(&dataset, &jrl::ReadOptions::default()).unwrap();
    graph.edges[0].information = Some(vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let said = jrl::write(&graph, false).unwrap_err().to_string();
    assert!(
        said.contains("odometry 0") && said.contains("no covariance") && said.contains("write g2o"),
        "{said}"
    );
    let mut many = PoseGraph::new(graph.header.clone());
    for id in 0..53 {
        many.nodes.push(posecut_graph::Node { id, session: Some(format!("s{id}")), ..Default::default() });
    }
    let said = jrl::write(&many, false).unwrap_err().to_string();
    assert!(said.contains("53 sessions") && said.contains("at most 52 robots"), "{said}");
}

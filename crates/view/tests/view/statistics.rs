//! The statistics of posecut-verify on a page.

use posecut_view::View;
use serde_json::{Value, json};

use crate::data_of;
use crate::graphs::{Content, graph, statistics};

#[test]
fn chains_are_named_by_their_sessions_or_nodes() {
    let graph = graph(Content::default());
    let mut given = statistics();
    let names = |given: &serde_json::Map<String, Value>| {
        let data = data_of(&View { statistics: Some(given), ..View::of(&graph) });
        let chains = data["verification"]["calibration"]["chains"].as_array().unwrap().clone();
        chains.iter().map(|chain| chain["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    // Odometry edge 30, from node 29 to node 30, is broken: its session is two chains.
    assert_eq!(
        names(&given),
        ["north/a, nodes 0 to 29", "north/a, nodes 30 to 39", "north/b, nodes 40 to 79"]
    );
    given["broken_odometry"] = json!([]);
    given["calibration"]["odometry"] = json!([1.4, 0.8]);
    assert_eq!(names(&given), ["north/a", "north/b"]);
    given["calibration"]["odometry"] = json!([1.4, 0.8, 1.0, 2.0]);
    assert_eq!(names(&given), ["chain 1", "chain 2", "chain 3", "chain 4"]);
}

#[test]
fn rivals_counts_and_broken_odometry_are_shown() {
    let graph = graph(Content::default());
    let given = statistics();
    let data = data_of(&View { statistics: Some(&given), ..View::of(&graph) });
    assert_eq!(data["verification"]["rivals"][0]["evidence"], 21.5);
    assert_eq!(data["verification"]["calibration"]["chains"][0]["coherent"], 0.01);
    assert_eq!(data["verification"]["counts"][0], json!(["landmark edges judged", 27.0]));
    assert_eq!(data["broken"], json!([{"id": "30", "from": 29, "to": 30, "why": "broken, by verify"}]));
}

#[test]
fn statistics_of_another_layout_are_left_out() {
    let graph = graph(Content::default());
    let given =
        json!({"calibration": [1, 2], "rivals": {"a": 1}, "broken_odometry": "none", "accepted": null});
    let data = data_of(&View { statistics: given.as_object(), ..View::of(&graph) });
    assert_eq!(data["verification"], json!({"counts": [], "calibration": null, "rivals": []}));
    assert_eq!(data["broken"], json!([]));
}

#[test]
fn odometry_that_a_stage_rejected_is_marked() {
    let mut graph = graph(Content::default());
    graph.edges[3].reject("mine");
    let data = data_of(&View::of(&graph));
    assert_eq!(data["broken"][0]["why"], "rejected by mine");
}

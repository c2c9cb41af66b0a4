//! What the maps of a page show: positions, components, states and residuals of edges.

use posecut_graph::PoseGraph;
use posecut_view::encode::decoded;
use posecut_view::{Alternative, Frame, Summary, View, page, summary};
use serde_json::{Value, json};

use crate::data_of;
use crate::graphs::{Content, graph};

fn numbers(text: &Value, step: &Value) -> Vec<f64> {
    decoded(text.as_str().unwrap(), step.as_f64().unwrap()).unwrap()
}

/// The names of the states of all edges.
fn states(map: &Value) -> Vec<String> {
    let index = numbers(&map["state"], &json!(1));
    index.iter().map(|&index| map["states"][index as usize]["name"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn positions_are_those_of_the_poses() {
    let graph = graph(Content { dimension: 3, ..Content::default() });
    let data = data_of(&View::of(&graph));
    let step = &data["step"];
    assert_eq!(step, 1e-4, "a rectangle of 60 m, to a hundred-thousandth or 0.1 mm");
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let drawn = numbers(&data["maps"][0]["positions"][name], step);
        assert_eq!(drawn.len(), graph.nodes.len());
        for (drawn, node) in drawn.iter().zip(&graph.nodes) {
            let own = node.pose.as_ref().unwrap()[axis];
            assert!((drawn - own).abs() <= 0.5e-4 + 1e-9, "{name} of node {}: {drawn} {own}", node.id);
        }
    }
}

#[test]
fn an_outlier_does_not_coarsen_the_map() {
    let mut graph = graph(Content::default());
    graph.nodes[5].pose = Some(vec![1e15, -1e15, 0.0]);
    let data = data_of(&View::of(&graph));
    assert_eq!(data["step"], 1e-4);
    let drawn = numbers(&data["maps"][0]["positions"]["x"], &data["step"]);
    assert!((drawn[6] - 30.0).abs() < 1e-3, "{}", drawn[6]);
}

#[test]
fn before_is_dead_reckoning_from_the_first_poses() {
    let graph = graph(Content::default());
    let data = data_of(&View::of(&graph));
    let before = &data["before"];
    assert_eq!((&before["reckoned"], &before["chains"]), (&json!(true), &json!(2)));
    let (x, y) = (
        numbers(&before["positions"]["x"], &data["step"]),
        numbers(&before["positions"]["y"], &data["step"]),
    );
    // Both chains begin at their first pose, and drift by 0.004 rad a step.
    for start in [0, 40] {
        assert!((x[start].abs() + y[start].abs()) < 1e-3);
        assert!((x[start + 1] - 5.0).abs() < 1e-3);
        let drift = (x[start + 10] - 50.0).hypot(y[start + 10]);
        assert!(drift > 0.5 && drift < 2.0, "{drift}");
    }
    // Poses that are dead reckoning themselves have nothing before them.
    let mut reckoned = graph.clone();
    for (node, (x, y)) in reckoned.nodes.iter_mut().zip(x.iter().zip(&y)) {
        let heading = 0.004 * (node.id % 40) as f64;
        let turned = node.pose.as_ref().unwrap()[2] + heading;
        node.pose = Some(vec![*x, *y, turned]);
    }
    assert_eq!(data_of(&View::of(&reckoned))["before"], Value::Null);
}

#[test]
fn before_is_the_given_graph_by_ids() {
    let graph = graph(Content::default());
    let mut given = graph.clone();
    given.nodes.remove(7);
    given.nodes[0].pose = Some(vec![3.0, 0.0, 0.0]);
    let data = data_of(&View { before: Some(&given), ..View::of(&graph) });
    assert_eq!(data["before"]["reckoned"], false);
    let x = numbers(&data["before"]["positions"]["x"], &data["step"]);
    assert!((x[0] - 3.0).abs() < 1e-3 && (x[8] - 40.0).abs() < 1e-3);
    assert!(data["before"]["positions"]["placed"].is_string(), "node 7 has no place");
}

#[test]
fn edges_are_in_use_undecided_or_rejected_by_a_stage() {
    let mut graph = graph(Content::default());
    let edge = |graph: &mut PoseGraph, id: u64| graph.edges.iter().position(|edge| edge.id == id).unwrap();
    let (first, second, third) = (edge(&mut graph, 100), edge(&mut graph, 200), edge(&mut graph, 300));
    graph.edges[first].rejected_by = Some("pcm".to_owned());
    graph.edges[second].readmit();
    let found = |graph: &PoseGraph| states(&data_of(&View::of(graph))["maps"][0]);
    let counted = summary(&graph);
    assert_eq!(counted, Summary { landmark_edges: 27, in_use: 10, undecided: 1, rejected: 16 });
    let names = found(&graph);
    assert_eq!((names[0].as_str(), names[10].as_str()), ("rejected by pcm", "in use"));
    assert_eq!(names[22], "undecided (not in use)");
    graph.edges[third].readmit();
    graph.edges[second].measurement = None;
    graph.edges[second].noise = None;
    let names = found(&graph);
    assert_eq!(
        (names[22].as_str(), names[10].as_str()),
        ("undecided (in use)", "in use, without measurement")
    );
    // An edge that another stage rejected is not undecided, whatever verification thought of it.
    graph.edges[third].reject("pcm");
    assert_eq!(found(&graph)[22], "rejected by pcm");
}

#[test]
fn residuals_are_between_measurement_and_map() {
    let graph = graph(Content::default());
    let data = data_of(&View::of(&graph));
    let metres = numbers(&data["maps"][0]["residuals"]["metres"], &data["steps"][0]);
    let degrees = numbers(&data["maps"][0]["residuals"]["degrees"], &data["steps"][1]);
    // Edge 100 measures the motion to the next viewpoint of the other lap, with a heading wrong by 0.01 rad.
    assert!(metres[0] < 1e-3 && (degrees[0] - 0.01_f64.to_degrees()).abs() < 0.01);
    // Edge 205 says that nodes 15 and 52 are one place, but they are 15 m apart, with one heading.
    assert!((metres[15] - 15.0).abs() < 1e-3 && degrees[15] < 0.01, "{} {}", metres[15], degrees[15]);
    let mut without = graph.clone();
    let edge = without.edges.iter().position(|edge| edge.id == 205).unwrap();
    (without.edges[edge].measurement, without.edges[edge].noise) = (None, None);
    let data = data_of(&View::of(&without));
    assert!(numbers(&data["maps"][0]["residuals"]["metres"], &data["steps"][0])[15] < 0.0);
}

#[test]
fn alternatives_are_matched_by_ids() {
    let main = graph(Content::default());
    let mut other = graph(Content { hypothesis: 1, ..Content::default() });
    other.edges.retain(|edge| edge.id != 200);
    let alternatives = [Alternative { name: "hypothesis 1", graph: &other }];
    let data = data_of(&View { alternatives: &alternatives, ..View::of(&main) });
    let map = &data["maps"][1];
    assert_eq!(map["name"], "hypothesis 1");
    let names = states(map);
    assert_eq!((names[0].as_str(), names[10].as_str()), ("rejected by verify", "not in this map"));
    assert_eq!(names[23], "in use");
    let x = numbers(&map["positions"]["x"], &data["step"]);
    assert!((x[40] - 50.0).abs() < 1e-3, "the second lap begins a quarter later");
}

#[test]
fn the_frame_follows_the_data() {
    let planes = |graph: &PoseGraph, frame| {
        let data = data_of(&View { frame, ..View::of(graph) });
        let names = |plane: &Value| {
            let axis =
                |name: &str| format!("{} {}", plane[name]["axis"], plane[name]["name"].as_str().unwrap());
            format!("{} | {}", axis("right"), axis("up"))
        };
        data["planes"].as_array().unwrap().iter().map(names).collect::<Vec<_>>()
    };
    let mut graph = graph(Content { dimension: 3, ..Content::default() });
    let plain = ["0 x | 1 y", "0 x | 2 z", "1 y | 2 z"];
    let nclt = ["1 y, east | 0 x, north", "0 x, north | 2 up, −z", "1 y, east | 2 up, −z"];
    assert_eq!(planes(&graph, Frame::Auto), plain);
    assert_eq!(planes(&graph, Frame::Ned), nclt);
    graph.header.provenance.insert(0, json!({"stage": "ingest"}));
    assert_eq!(planes(&graph, Frame::Auto), nclt);
    assert_eq!(planes(&graph, Frame::Xy), plain);
}

/// The poses of a camera have y downwards: seen from above in its own axes, a drive would be a line.
#[test]
fn a_map_in_the_frame_of_a_camera_is_seen_from_its_side() {
    let mut graph = graph(Content { dimension: 3, ..Content::default() });
    assert_eq!(data_of(&View::of(&graph))["plane"], 0);
    for node in &mut graph.nodes {
        let pose = node.pose.as_mut().unwrap();
        (pose[1], pose[2]) = (0.1 * pose[2], pose[1]);
    }
    assert_eq!(data_of(&View::of(&graph))["plane"], 1);
}

#[test]
fn components_apart_are_counted_and_said_to_mean_nothing() {
    let together = data_of(&View::of(&graph(Content::default())));
    assert_eq!(
        (&together["maps"][0]["parts"]["count"], &together["maps"][0]["parts"]["index"]),
        (&json!(1), &Value::Null)
    );
    let apart = graph(Content { hypothesis: 2, ..Content::default() });
    let text = page(&View::of(&apart)).unwrap();
    assert!(text.contains(
        "components that no edge in use joins: their positions relative to each other mean nothing"
    ));
    let data = crate::data(&text);
    assert_eq!(data["maps"][0]["parts"]["sizes"], json!([40, 40]));
    let part = numbers(&data["maps"][0]["parts"]["index"], &json!(1));
    assert_eq!((part[0], part[39], part[40], part[79]), (0.0, 0.0, 1.0, 1.0));
    assert_eq!(data["doubts"][0]["doubt"], "parts-not-connected");
    // An edge without a measurement joins nothing: the optimiser leaves it out.
    let mut unmeasured = graph(Content::default());
    for edge in unmeasured.edges.iter_mut().filter(|edge| edge.id >= 100) {
        (edge.measurement, edge.noise) = (None, None);
    }
    assert_eq!(data_of(&View::of(&unmeasured))["maps"][0]["parts"]["count"], 2);
}

#[test]
fn graphs_without_poses_show_dead_reckoning_and_empty_ones_nothing() {
    let data = data_of(&View::of(&graph(Content { poses: false, ..Content::default() })));
    assert_eq!(data["maps"][0]["positions"], Value::Null);
    assert_eq!(data["before"]["chains"], 2);
    let mut graph = graph(Content { poses: false, ..Content::default() });
    graph.edges.retain(|edge| edge.id >= 100);
    assert_eq!(data_of(&View::of(&graph))["before"], Value::Null);
    let data = data_of(&View::of(&PoseGraph::new(graph.header.clone())));
    assert_eq!((&data["nodes"]["count"], &data["edges"]["count"]), (&json!(0), &json!(0)));
    assert_eq!((&data["maps"][0]["positions"], &data["before"]), (&Value::Null, &Value::Null));
}

#[test]
fn fields_and_witnesses_of_stages_are_there_whatever_their_names() {
    let mut graph = graph(Content::default());
    let edge = graph.edges.iter_mut().find(|edge| edge.id == 205).unwrap();
    edge.extra.insert("my_own".to_owned(), json!(0.123_456_789));
    let data = data_of(&View::of(&graph));
    let columns = data["maps"][0]["columns"].as_array().unwrap();
    let column = |name: &str| columns.iter().find(|column| column["name"] == name).unwrap();
    assert_eq!(column("my_own")["numbers"][15], 0.123_457);
    assert_eq!(column("my_own")["numbers"][0], Value::Null);
    assert_eq!(column("score")["numbers"][0], 0.55);
    assert_eq!(column("verify_reason")["words"]["words"][1], "contradicted");
    let count = numbers(&data["maps"][0]["witnesses"]["count"], &json!(1));
    let ids = numbers(&data["maps"][0]["witnesses"]["id"]["series"], &json!(1));
    assert_eq!((count[0], count[15], count[22]), (1.0, 2.0, 0.0));
    assert_eq!((ids[0], &ids[20..22]), (101.0, &[100.0, 101.0][..]));
}

//! Tests the counts of edges by bins of their probability.

use posecut_evaluate::calibration::calibration;
use posecut_evaluate::{Options, evaluate};
use posecut_graph::PoseGraph;

/// A graph with two nodes, and one landmark edge for each pair of truth and probability (as JSON).
fn graph(edges: &[(Option<bool>, Option<&str>)]) -> PoseGraph {
    let mut text =
        String::from("{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n");
    for id in [0, 1] {
        text += &format!("{{\"kind\":\"node\",\"id\":{id},\"pose\":[{id},0,0]}}\n");
    }
    for (id, (truth, probability)) in edges.iter().enumerate() {
        let truth = truth.map_or(String::new(), |correct| format!(",\"truth\":{{\"correct\":{correct}}}"));
        let own = probability.map_or(String::new(), |value| format!(",\"verify_probability\":{value}"));
        text += &format!("{{\"kind\":\"landmark\",\"id\":{id},\"from\":0,\"to\":1{truth}{own}}}\n");
    }
    PoseGraph::read("test", text.as_bytes()).unwrap()
}

#[test]
fn an_edge_counts_in_the_bin_of_its_probability() {
    let found = calibration(&graph(&[
        (Some(false), Some("0")),
        (Some(true), Some("0.0999")),
        // The lower end belongs to its bin, and 1 to the last bin.
        (Some(true), Some("0.5")),
        (Some(false), Some("0.9")),
        (Some(true), Some("1")),
        (Some(true), Some("1.0")),
        // Neither of these has both a probability and a truth.
        (None, Some("0.5")),
        (Some(true), None),
        (Some(true), Some("null")),
    ]))
    .unwrap()
    .unwrap();
    assert_eq!(found.edges, [2, 0, 0, 0, 0, 1, 0, 0, 0, 3]);
    assert_eq!(found.correct, [1, 0, 0, 0, 0, 1, 0, 0, 0, 2]);
    assert_eq!(found.probability[9], 2.9);
    assert_eq!(found.probability[0], 0.0999);
}

#[test]
fn without_probabilities_or_truth_the_result_has_no_such_field() {
    let written = |edges: &[(Option<bool>, Option<&str>)]| {
        let estimate = graph(edges);
        serde_json::to_value(evaluate(&estimate, Some(&estimate), &Options::DEFAULT).unwrap()).unwrap()
    };
    for edges in [&[][..], &[(Some(true), None)], &[(None, Some("0.5"))], &[(Some(true), Some("null"))]] {
        assert!(written(edges).get("calibration").is_none(), "{edges:?}");
    }
    let record = &written(&[(Some(true), Some("0.25"))])["calibration"];
    let bins = serde_json::json!({
        "edges": [0, 0, 1, 0, 0, 0, 0, 0, 0, 0],
        "probability": [0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        "correct": [0, 0, 1, 0, 0, 0, 0, 0, 0, 0],
    });
    assert_eq!(record, &bins);
}

#[test]
fn what_is_no_probability_is_refused_with_the_edge() {
    for value in ["1.000001", "-0.1", "\"0.5\"", "true", "[]"] {
        let said = calibration(&graph(&[(None, Some("0.5")), (None, Some(value))])).unwrap_err().to_string();
        assert!(said.contains("landmark 1") && said.contains(value), "{said}");
    }
}

//! A written graph reads back to the same bits, and a graph in canonical form is written as it was read.

use posecut_graph::{
    Dimension, Edge, EdgeKind, EdgeTruth, Header, Node, NodeTruth, PoseGraph, Prior, PriorOf, WriteError,
};
use proptest::prelude::*;

fn written(graph: &PoseGraph) -> Vec<u8> {
    let mut bytes = Vec::new();
    graph.write(&mut bytes).unwrap();
    bytes
}

/// Any finite number: all signs and exponents, subnormal ones too, and whole numbers.
fn finite() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |value| value.is_finite()),
        (-1_000_000_i64..1_000_000).prop_map(|whole| whole as f64),
        Just(-0.0),
        Just(9_007_199_254_740_993.0),
    ]
}

prop_compose! {
    fn any_graph()(
        poses in proptest::collection::vec(proptest::array::uniform3(finite()), 1..8),
        measurements in proptest::collection::vec(proptest::array::uniform3(finite()), 0..8),
        cost in proptest::option::of(finite()),
        text in "[a-zA-Z\"\\\\/ \u{e9}\u{1f916}]{0,12}",
        order in any::<u64>(),
    ) -> PoseGraph {
        let mut graph = PoseGraph::new(Header::new(Dimension::Two));
        let count = poses.len() as u64;
        for (id, pose) in poses.into_iter().enumerate() {
            graph.nodes.push(Node {
                id: id as u64,
                session: Some(text.clone()),
                frame: Some(-(id as i64)),
                utime: Some(1_327_194_947_000_001),
                truth: Some(NodeTruth { pose: Some(pose.to_vec()), ..NodeTruth::default() }),
                pose: Some(pose.to_vec()),
                ..Node::default()
            });
        }
        if count > 1 {
            for (id, measurement) in measurements.into_iter().enumerate() {
                let mut edge = Edge::new(EdgeKind::Landmark, id as u64, order % count, (order + 1) % count);
                edge.measurement = Some(measurement.to_vec());
                edge.information = Some(vec![1.0 / 3.0, 0.1, 0.0, 2.0, -0.0, 1e300]);
                edge.cost = cost;
                edge.truth = Some(EdgeTruth { correct: Some(id % 2 == 0), ..EdgeTruth::default() });
                edge.extra.insert(text.clone() + "?", serde_json::json!({"a": [1, 2.5, null]}));
                graph.edges.push(edge);
            }
        }
        for (id, pose) in graph.nodes.iter().filter_map(|node| node.pose.as_ref()).enumerate() {
            let whole = id % 2 == 0;
            graph.priors.push(Prior {
                id: 3 * id as u64,
                node: order % count,
                measurement: if whole { pose.clone() } else { pose[..2].to_vec() },
                information: Some(if whole { vec![1.0 / 3.0, 0.1, 0.0, 2.0, -0.0, 1e300] } else { vec![1.0 / 3.0, -0.0, 7.0] }),
                source: Some(text.clone()),
                score: cost,
                ..Prior::default()
            });
        }
        graph
    }
}

proptest! {
    #[test]
    fn numbers_and_texts_survive_bit_for_bit(graph in any_graph()) {
        let bytes = written(&graph);
        let again = PoseGraph::read("test", bytes.as_slice()).unwrap();
        let bits = |graph: &PoseGraph| -> Vec<u64> {
            let poses = graph.nodes.iter().flat_map(|node| node.pose.iter().flatten());
            let edges = graph.edges.iter().flat_map(|edge| edge.measurement.iter().chain(&edge.information).flatten());
            let priors = graph.priors.iter().flat_map(|prior| prior.measurement.iter().chain(prior.information.iter().flatten()));
            poses.chain(edges).chain(priors).map(|value| value.to_bits()).collect()
        };
        prop_assert_eq!(bits(&graph), bits(&again));
        prop_assert_eq!(&graph, &again);
        prop_assert_eq!(bytes, written(&again));
    }

    #[test]
    fn the_order_of_records_does_not_matter(graph in any_graph(), swaps in proptest::collection::vec((0_usize..20, 0_usize..20), 0..20)) {
        let text = String::from_utf8(written(&graph)).unwrap();
        let mut lines: Vec<&str> = text.lines().collect();
        let count = lines.len();
        for (one, other) in swaps {
            lines.swap(1 + one % (count - 1), 1 + other % (count - 1));
        }
        let shuffled = PoseGraph::read("test", lines.join("\r\n").as_bytes()).unwrap();
        prop_assert_eq!(graph, shuffled);
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = PoseGraph::read("test", bytes.as_slice());
    }

    #[test]
    fn no_damage_makes_the_reader_panic(graph in any_graph(), place in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = written(&graph);
        let place = place.index(bytes.len());
        bytes[place] = byte;
        let _ = PoseGraph::read("test", bytes.as_slice());
        bytes.truncate(place);
        let _ = PoseGraph::read("test", bytes.as_slice());
    }
}

#[test]
fn the_canonical_form_is_a_fixed_point_and_as_documented() {
    let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{"odometry":{"information":[4,0,0,4,0,0.1]}},"provenance":[{"stage":"x"}],"extra":true}
{"kind":"node","id":0,"session":"a","frame":0,"utime":5,"pose":[0,-0.0,0.1],"landmark":3,"truth":{"pose":[0,0,0],"by":"me"},"mood":null}
{"kind":"node","id":7}
{"kind":"odometry","id":0,"from":0,"to":7,"measurement":[1,2.5,1e-7],"noise":"odometry"}
{"kind":"landmark","id":1,"from":7,"to":0,"truth":{"correct":false},"rejected_by":"pcm","cost":-1,"score":0.83,"seen":[1]}
{"kind":"prior","id":0,"node":7,"measurement":[1,-0.0,0.1],"noise":"odometry","source":"map"}
{"kind":"prior","id":9,"node":0,"measurement":[1.5,2],"information":[4,0,0.1],"source":"gps","truth":{"correct":true,"by":"me"},"rejected_by":"optimize","score":0.5,"sats":7}
{"kind":"note", "spaced" : "out"}
"#;
    let graph = PoseGraph::read("test", text.as_bytes()).unwrap();
    assert_eq!(String::from_utf8(written(&graph)).unwrap(), text);
}

#[test]
fn a_byte_order_mark_and_blank_lines_are_no_fault() {
    let text = "\u{feff}{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":3}\n\n  \n{\"kind\":\"node\",\"id\":4}\n";
    assert_eq!(PoseGraph::read("test", text.as_bytes()).unwrap().nodes.len(), 1);
}

#[test]
fn null_counts_as_absent() {
    let text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n{\"kind\":\"node\",\"id\":4,\"pose\":null,\"session\":null}\n";
    let graph = PoseGraph::read("test", text.as_bytes()).unwrap();
    assert_eq!((graph.nodes[0].pose.clone(), graph.nodes[0].session.clone()), (None, None));
}

#[test]
fn nan_is_not_written_and_nothing_is_written_before_it_is_found() {
    let mut graph = PoseGraph::new(Header::new(Dimension::Two));
    graph.nodes.push(Node { id: 17, pose: Some(vec![0.0, f64::NAN, 0.0]), ..Node::default() });
    let mut bytes = Vec::new();
    let error = graph.write(&mut bytes).unwrap_err();
    assert!(matches!(error, WriteError::NotFinite { field: "pose", .. }), "{error}");
    assert!(error.to_string().starts_with("node 17, field \"pose\": the value is NaN"), "{error}");
    assert!(bytes.is_empty());
}

/// Every refusal of a prior names line, prior and field. Without its change the prior is read.
#[test]
fn impossible_priors_are_refused() {
    let prior = |rest: &str| format!("{{\"kind\":\"prior\",\"id\":4,{rest}}}");
    let read = |dimension: u32, lines: &str| {
        let text = format!(
            "{{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":{dimension},\"noise_models\":{{}}}}\n{{\"kind\":\"node\",\"id\":0}}\n{lines}\n"
        );
        PoseGraph::read("test", text.as_bytes()).map_err(|error| error.to_string())
    };
    let sound = r#""node":0,"measurement":[1,2],"information":[1,0,1]"#;
    assert!(read(2, &prior(sound)).is_ok());
    let spatial = r#""node":0,"measurement":[1,2,3],"information":[1,0,0,1,0,0]"#;
    assert_eq!(read(3, &prior(spatial)).unwrap().priors[0].of(Dimension::Three), Some(PriorOf::Position));
    let cases = [
        (2, sound.replace("1,2]", "NaN,2]"), "line 3, prior 4, field \"measurement\": NaN"),
        (2, sound.replace("1,2]", "1e999,2]"), "line 3, prior 4, field \"measurement\": a number is too large"),
        (2, sound.replace("1,0,1", "1,2,1"), "line 3, prior 4, field \"information\": the matrix is not positive"),
        (2, sound.replace("1,0,1", "1,0"), "line 3, prior 4, field \"information\": expected 3 numbers, found 2"),
        (2, sound.replace("1,2]", "1,2,3,4]"), "line 3, prior 4, field \"measurement\": expected 3 or 2 numbers, found 4"),
        (3, sound.to_owned(), "line 3, prior 4, field \"measurement\": expected 7 or 3 numbers, found 2"),
        (2, sound.replace("\"node\":0", "\"node\":9"), "line 3, prior 4, field \"node\": there is no node 9"),
        (2, sound.replace("\"information\":[1,0,1]", "\"noise\":\"x\""), "line 3, prior 4, field \"noise\": a noise model is for poses"),
        (2, r#""node":0,"measurement":[1,2,3],"noise":"x""#.to_owned(), "line 3, prior 4, field \"noise\": the header has no noise model \"x\""),
        (2, r#""node":0,"measurement":[1,2,3]"#.to_owned(), "line 3, prior 4, field \"information\": the prior has no information"),
        (2, r#""node":0,"information":[1,0,1]"#.to_owned(), "line 3, prior 4, field \"measurement\": the field is missing"),
        (3, r#""node":0,"measurement":[0,0,0,0,0,0,2],"information":[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0]"#.to_owned(), "line 3, prior 4, field \"measurement\": the quaternion has norm 2"),
    ];
    for (dimension, rest, expected) in cases {
        let error = read(dimension, &prior(&rest)).unwrap_err();
        assert!(error.starts_with(&format!("test, {expected}")) && error.contains("; "), "{rest}: {error}");
    }
    let error = read(2, &format!("{}\n{}", prior(sound), prior(sound))).unwrap_err();
    assert!(
        error.starts_with("test, line 4, prior 4, field \"id\": line 3 (prior 4) already has this id; ids must be unique among priors"),
        "{error}"
    );
}

#[test]
fn a_prior_that_is_not_finite_is_not_written() {
    let mut graph = PoseGraph::new(Header::new(Dimension::Two));
    graph.priors.push(Prior { id: 3, measurement: vec![f64::INFINITY, 0.0], ..Prior::default() });
    let error = graph.write(std::io::sink()).unwrap_err();
    assert!(error.to_string().starts_with("prior 3, field \"measurement\": the value is inf"), "{error}");
}

#[test]
fn quaternions_far_from_unit_norm_are_refused() {
    let text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":3}\n{\"kind\":\"node\",\"id\":4,\"pose\":[0,0,0,0,0,0,0.9]}\n";
    let error = PoseGraph::read("test", text.as_bytes()).unwrap_err().to_string();
    assert!(
        error.starts_with("test, line 2, node 4, field \"pose\": the quaternion has norm 0.9"),
        "{error}"
    );
}

#[test]
fn information_semidefinite_in_print_is_accepted() {
    let text = |last: &str| {
        format!(
            "{{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}}\n{{\"kind\":\"node\",\"id\":0}}\n{{\"kind\":\"node\",\"id\":1}}\n{{\"kind\":\"landmark\",\"id\":0,\"from\":0,\"to\":1,\"measurement\":[0,0,0],\"information\":[1,1,0,{last},0,1]}}\n"
        )
    };
    assert!(PoseGraph::read("test", text("1").as_bytes()).is_ok());
    assert!(PoseGraph::read("test", text("0.9999999999").as_bytes()).is_ok(), "rounding in print");
    assert!(PoseGraph::read("test", text("0.99").as_bytes()).is_err(), "no rounding explains this");
}

#[test]
fn doubts_of_the_provenance_are_read_where_there_are_some() {
    let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"provenance":[{"stage":"old","version":"0"},{"stage":"pcm","version":"1","doubts":["nothing-kept","of-tomorrow"]},{"stage":"pcm","version":"1","doubts":["nothing-kept"]},"of another layout",{"stage":3,"doubts":["x"]},{"stage":"odd","doubts":{"a":1}},{"doubts":[1]}]}
"#;
    let graph = PoseGraph::read("test", text.as_bytes()).unwrap();
    let found = graph.header.doubts();
    let found: Vec<(&str, &str)> =
        found.iter().map(|found| (found.stage.as_str(), found.doubt.as_str())).collect();
    assert_eq!(found, [("pcm", "nothing-kept"), ("pcm", "of-tomorrow")]);
    let mut bytes = Vec::new();
    graph.write(&mut bytes).unwrap();
    assert_eq!(String::from_utf8(bytes).unwrap(), text, "unknown layouts pass through");
}

#[test]
fn provenance_without_doubts_keeps_its_bytes_and_is_read_without_the_field() {
    let text = r#"{"stage":"pcm","version":"1","arguments":{},"seed":null,"inputs":[]}"#;
    let entry: posecut_graph::Provenance = serde_json::from_str(text).unwrap();
    assert!(entry.doubts.is_empty());
    assert_eq!(serde_json::to_string(&entry).unwrap(), text);
}

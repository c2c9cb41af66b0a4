//! Tests findings, differences and parts of small graphs.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_graph::PoseGraph;
use posecut_inspect::difference::Difference;
use posecut_inspect::filter::{Kind, Options, Range, Rejected, Truth, filter};
use posecut_inspect::info::Info;
use posecut_inspect::validate::{Finding, Severity, validate};

const GRAPH: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{"wheels":{"information":[1,0,0,1,0,1]}},"provenance":[{"stage":"ingest","version":"0.1.0","arguments":{"name":null,"period":0.2}}]}
{"kind":"node","id":0,"session":"d/a","frame":0,"utime":1000000,"pose":[0,0,0]}
{"kind":"node","id":1,"session":"d/a","frame":1,"utime":2000000,"pose":[3,4,0]}
{"kind":"node","id":2,"session":"d/b","frame":2,"utime":3000000,"pose":[-1,5,3.1]}
{"kind":"node","id":3,"session":"e","frame":0,"utime":4000000,"pose":[1,1,-3.1]}
{"kind":"odometry","id":0,"from":0,"to":1,"measurement":[1,0,0],"noise":"wheels"}
{"kind":"landmark","id":1,"from":0,"to":2,"measurement":[1,0,0],"noise":"wheels","truth":{"correct":true}}
{"kind":"landmark","id":2,"from":1,"to":3,"measurement":[1,0,0],"information":[1,0,0,1,0,1],"truth":{"correct":false},"rejected_by":"pcm","mood":"bad"}
{"kind":"gps","at":[1,2]}
"#;

fn graph(text: &str) -> PoseGraph {
    PoseGraph::read("test", text.as_bytes()).unwrap()
}

fn findings(text: &str) -> Vec<Finding> {
    validate("test", text.as_bytes()).unwrap()
}

#[test]
fn info_counts_everything() {
    let info = Info::of(&graph(GRAPH));
    assert_eq!((info.nodes, info.odometry.count, info.landmark.count, info.landmark.in_use), (4, 1, 2, 1));
    assert_eq!(info.landmark.between_sessions, 2);
    assert_eq!(
        info.sessions.iter().map(|session| session.name.as_str()).collect::<Vec<_>>(),
        ["d/a", "d/b", "e"]
    );
    let bounds = info.bounding_box.clone().unwrap();
    assert_eq!((bounds.smallest, bounds.largest), (vec![-1.0, 0.0], vec![3.0, 5.0]));
    assert_eq!(info.components.sizes, [3, 1], "a rejected edge holds nothing together");
    assert_eq!(info.rejected_by["pcm"], 1);
    assert_eq!(info.noise_models["wheels"], 2);
    let edges = info.edges.clone().unwrap();
    assert_eq!((edges.precision, edges.recall), (Some(1.0), Some(1.0)));
    assert_eq!(info.provenance, ["ingest 0.1.0 period=0.2"]);
    assert_eq!((info.unknown_records, info.unknown_fields["landmark.mood"]), (1, 1));
    let text = info.to_string();
    for part in [
        "x -1.000 to 3.000 m",
        "rejected     1 by pcm",
        "components   2 (nodes: 3, 1)",
        "field landmark.mood",
    ] {
        assert!(text.contains(part), "\"{part}\" is not in:\n{text}");
    }
}

#[test]
fn all_faults_are_found_and_not_the_first_alone() {
    let bad = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0,"pose":[0,0]}
{"kind":"node","id":1}
{"kind":"node","id":1}
nonsense
{"kind":"landmark","id":0,"from":1,"to":8,"measurement":[0,0,0],"information":[1,2,0,1,0,1]}
{"kind":"landmark","id":1,"from":1,"to":9}
{"kind":"landmark","id":2,"from":7,"to":9}
"#;
    let found = findings(bad);
    let faults: Vec<(u64, Option<&str>)> = found
        .iter()
        .filter(|finding| finding.severity == Severity::Fault)
        .map(|finding| (finding.line, finding.field.as_deref()))
        .collect();
    assert_eq!(
        faults,
        [
            (2, Some("pose")),
            (5, None),
            (6, Some("information")),
            (4, Some("id")),
            (7, Some("to")),
            (8, Some("from")),
            (8, Some("to"))
        ]
    );
    assert_eq!(found[0].record.as_deref(), Some("node 0"));
    let header = findings("{\"kind\":\"node\",\"id\":0}\n");
    assert_eq!((header.len(), header[0].line), (1, 1), "without a header nothing else can be judged");
}

/// Each change causes its own warning. Unchanged, the graph has only the warning about its two components.
#[test]
fn warnings_name_what_is_strange() {
    let only: Vec<String> = findings(GRAPH).iter().map(ToString::to_string).collect();
    assert_eq!(only.len(), 1, "{only:?}");
    assert!(
        only[0].starts_with("warning: line 5, node 3: it is the first node of the second of 2 components"),
        "{}",
        only[0]
    );
    for (from, to, part) in [
        (
            "\"frame\":1",
            "\"frame\":0",
            "line 3, node 1, field \"frame\": node 0 of the same session has frame 0 too",
        ),
        ("\"utime\":2000000", "\"utime\":5", "field \"utime\": its time 5 is before"),
        (",\"pose\":[3,4,0]", "", "node 1, field \"pose\": it is the first of 1 node without a pose"),
        (
            "\"information\":[1,0,0,1,0,1],",
            "\"information\":[1,0,0,1,0,0],",
            "line 8, landmark 2, field \"information\": the matrix is singular",
        ),
        (
            "[1,0,0,1,0,1]}}",
            "[1,0,0,1e-30,0,0]}}",
            "line 1, header, field \"noise_models.wheels.information\"",
        ),
        (
            "\"from\":0,\"to\":1,",
            "\"from\":0,\"to\":3,",
            "odometry 0, field \"to\": an odometry edge joins two sessions",
        ),
        (
            "\"noise\":\"wheels\"}\n",
            "\"noise\":\"wheels\",\"rejected_by\":\"x\"}\n",
            "x rejected an odometry edge",
        ),
        (
            "\"id\":1,\"session\"",
            "\"id\":9,\"session\"",
            "line 3, field \"id\": the nodes are not in the order",
        ),
        (
            "\"from\":1,\"to\":3",
            "\"from\":2,\"to\":0",
            "landmark 2, field \"to\": it joins the same nodes as landmark 1",
        ),
        ("\"stage\":\"ingest\",", "", "entry 1 has no \"stage\""),
        (
            "\"wheels\":{\"inf",
            "\"laser\":{\"information\":[1,0,0,1,0,1]},\"wheels\":{\"inf",
            "no edge uses the noise model \"laser\"",
        ),
    ] {
        let mut text = GRAPH.replacen(from, to, 1);
        if from.contains("\"id\":1,\"session") {
            text = text.replace("\"to\":1,", "\"to\":9,").replace("\"from\":1,", "\"from\":9,");
        }
        if part.contains("joins the same") {
            text = text.replace(",\"rejected_by\":\"pcm\"", "");
        }
        assert_ne!(text, GRAPH, "{part}");
        let found: Vec<String> = findings(&text).iter().map(ToString::to_string).collect();
        assert!(found.iter().any(|finding| finding.contains(part)), "\"{part}\" is not in {found:#?}");
        assert!(found.iter().all(|finding| finding.starts_with("warning: ")), "{found:#?}");
    }
}

#[test]
fn a_graph_is_the_same_as_itself_and_its_history_does_not_count() {
    let first = graph(GRAPH);
    let mut second = first.clone();
    assert!(Difference::between(&first, &second, 0.0).unwrap().same);
    second.header.provenance.push(serde_json::json!({"stage": "pcm", "version": "1"}));
    let difference = Difference::between(&first, &second, 0.0).unwrap();
    assert!(difference.same);
    assert_eq!(difference.provenance_added, ["pcm 1"]);
}

#[test]
fn differences_are_told_by_record_and_field() {
    let first = graph(GRAPH);
    let mut second = graph(&GRAPH.replace("[-1,5,3.1]", "[2,9,-3.1]"));
    second.edges[1].reject("multicut");
    second.edges[2].rejected_by = None;
    second.edges[2].cost = Some(1.0);
    second.edges.remove(0);
    second.nodes[3].extra.insert("new".to_owned(), 1.into());
    second.unknown.clear();
    let difference = Difference::between(&first, &second, 0.0).unwrap();
    assert!(!difference.same);
    assert_eq!(
        (difference.edges.removed.as_slice(), difference.edges.changed.as_slice()),
        (&[0][..], &[1, 2][..])
    );
    assert_eq!(difference.marked["multicut"], [1]);
    assert_eq!(difference.unmarked["pcm"], [2]);
    assert_eq!(
        (difference.edges.fields["cost"].added, difference.edges.fields["rejected_by"].removed),
        (1, 1)
    );
    assert_eq!(difference.nodes.changed, [2, 3]);
    assert_eq!(difference.unknown_removed, 1);
    let moved = &difference.moved[0];
    assert_eq!((difference.moved.len(), moved.id), (1, 2));
    assert!((moved.translation - 5.0).abs() < 1e-12, "{}", moved.translation);
    assert!(
        (moved.rotation - (std::f64::consts::TAU - 6.2)).abs() < 1e-12,
        "the short way round, {}",
        moved.rotation
    );
    let backwards = Difference::between(&second, &first, 0.0).unwrap();
    assert_eq!((backwards.edges.added, backwards.unknown_added), (vec![0], 1));
}

#[test]
fn a_tolerance_forgives_small_numbers_and_ids_never() {
    let first = graph(GRAPH);
    let second = graph(&GRAPH.replace("[3,4,0]", "[3.001,4,0]"));
    assert!(!Difference::between(&first, &second, 1e-4).unwrap().same);
    assert!(Difference::between(&first, &second, 1e-2).unwrap().same);
    let large = |frame: &str| graph(&GRAPH.replace("\"frame\":2", &format!("\"frame\":{frame}")));
    let (one, two) = (large("9007199254740992"), large("9007199254740993"));
    assert!(!Difference::between(&one, &two, 0.0).unwrap().same, "the same double, and another number");
}

fn part(options: &Options) -> PoseGraph {
    let mut part = graph(GRAPH);
    filter(&mut part, options);
    let mut bytes = Vec::new();
    part.write(&mut bytes).unwrap();
    assert_eq!(PoseGraph::read("part", bytes.as_slice()).unwrap(), part, "a part is a sound graph");
    part
}

fn ids(graph: &PoseGraph) -> (Vec<u64>, Vec<u64>) {
    (graph.nodes.iter().map(|node| node.id).collect(), graph.edges.iter().map(|edge| edge.id).collect())
}

#[test]
fn parts_are_sound_and_hold_what_was_asked_for() {
    let all = Options::default();
    let range = |text: &str| Some(text.parse::<Range>().unwrap());
    let cases = [
        (all.clone(), vec![0, 1, 2, 3], vec![0, 1, 2]),
        (Options { session: vec!["d".to_owned()], ..all.clone() }, vec![0, 1, 2], vec![0, 1]),
        (
            Options { session: vec!["d/a".to_owned(), "e".to_owned()], ..all.clone() },
            vec![0, 1, 3],
            vec![0, 2],
        ),
        (Options { nodes: range("1.."), ..all.clone() }, vec![1, 2, 3], vec![2]),
        (Options { nodes: range("..1"), ..all.clone() }, vec![0, 1], vec![0]),
        (Options { frames: range("0..0"), ..all.clone() }, vec![0, 3], vec![]),
        (Options { times: range("2000000..3000000"), ..all.clone() }, vec![1, 2], vec![]),
        (Options { component: Some(1), ..all.clone() }, vec![0, 1, 2], vec![0, 1]),
        (Options { component: Some(2), ..all.clone() }, vec![3], vec![]),
        (Options { component: Some(3), ..all.clone() }, vec![], vec![]),
        (Options { kind: Some(Kind::Landmark), ..all.clone() }, vec![0, 1, 2, 3], vec![1, 2]),
        (Options { kind: Some(Kind::Odometry), ..all.clone() }, vec![0, 1, 2, 3], vec![0]),
        (Options { rejected: Some(Rejected::Yes), ..all.clone() }, vec![0, 1, 2, 3], vec![0, 2]),
        (Options { rejected: Some(Rejected::No), ..all.clone() }, vec![0, 1, 2, 3], vec![0, 1]),
        (Options { truth: Some(Truth::Correct), ..all.clone() }, vec![0, 1, 2, 3], vec![0, 1]),
        (Options { truth: Some(Truth::Incorrect), ..all.clone() }, vec![0, 1, 2, 3], vec![0, 2]),
        (Options { truth: Some(Truth::Unknown), ..all.clone() }, vec![0, 1, 2, 3], vec![0]),
    ];
    for (options, nodes, edges) in cases {
        let part = part(&options);
        assert_eq!(ids(&part), (nodes, edges), "{options:?}");
        assert_eq!(part.unknown.len(), 1, "unknown records stay");
    }
    let blind = part(&Options { strip_truth: true, ..all });
    assert!(blind.edges.iter().all(|edge| edge.truth.is_none()));
}

#[test]
fn ranges_that_are_none_are_refused() {
    for text in ["", "5", "5..3", "a..b", "1...2", "99999999999999999999.."] {
        assert!(text.parse::<Range>().is_err(), "{text}");
    }
    assert_eq!("-5..".parse::<Range>().unwrap(), Range { first: Some(-5), last: None });
}

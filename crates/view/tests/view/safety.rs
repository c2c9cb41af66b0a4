//! Files of unknown origin cannot change what a page does, and a page claims no truth that nobody gave.

use posecut_graph::PoseGraph;
use posecut_view::{Alternative, Remark, Severity, View, page};
use serde_json::json;

use crate::graphs::{Content, graph};
use crate::{data, data_of};

const HOSTILE: &str = "</script><script>alert('1')</script><!--\u{2028}\"><img onerror=alert(1)> {{data}}";

#[test]
fn hostile_names_stay_text() {
    let mut graph = graph(Content { sessions: [HOSTILE, "b"], ..Content::default() });
    let edge = graph.edges.iter_mut().find(|edge| edge.id == 300).unwrap();
    edge.reject(HOSTILE);
    edge.extra.insert("verify_reason".to_owned(), HOSTILE.into());
    edge.extra.insert(HOSTILE.to_owned(), HOSTILE.into());
    let remark = || HOSTILE.to_owned();
    let remark = Remark { severity: Severity::Error, title: remark(), text: remark(), remedy: remark() };
    let statistics = json!({HOSTILE: HOSTILE, "calibration": {"odometry": [1, 2]}});
    let view = View {
        title: HOSTILE,
        remarks: &[remark],
        alternatives: &[Alternative { name: HOSTILE, graph: &graph }],
        statistics: statistics.as_object(),
        ..View::of(&graph)
    };
    let text = page(&view).unwrap();
    assert_eq!(text.matches("<script").count(), 2, "the data and the page's own");
    assert_eq!(text.matches("</script").count(), 2);
    assert!(!text.contains("<img") && !text.contains("<!--"));
    let data = data(&text);
    assert_eq!(data["nodes"]["sessions"][0], HOSTILE);
    assert_eq!(data["maps"][1]["name"], HOSTILE);
    assert_eq!(data["remarks"][0]["title"], HOSTILE);
}

#[test]
fn a_page_needs_no_network_and_allows_none() {
    let text = page(&View::of(&graph(Content::default()))).unwrap();
    let own = text.replace("http://www.w3.org/2000/svg", "");
    for address in ["http:", "https:", "src=", "url(", "@import", "innerHTML", "insertAdjacent", "eval("] {
        assert!(!own.contains(address), "{address}");
    }
    assert!(text.contains("default-src 'none'; style-src 'sha256-"));
}

/// Without labels, nobody knows which edges are correct: the whole page does not contain the word, in whatever form.
#[test]
fn without_labels_a_page_calls_no_edge_correct() {
    let with = |labels| page(&View::of(&graph(Content { labels, ..Content::default() }))).unwrap();
    let text = with(false);
    assert!(!text.contains("correct"), "{:?}", text.split("correct").next().unwrap().lines().last());
    let labelled = data(&with(true));
    assert_eq!(labelled["edges"]["label"]["words"]["words"], json!(["correct", "incorrect"]));
    // What became of the edges is named in the same words.
    assert_eq!(labelled["maps"][0]["states"], data(&text)["maps"][0]["states"]);
}

#[test]
fn the_same_view_gives_the_same_bytes() {
    let one = page(&View::of(&graph(Content::default()))).unwrap();
    assert!(one == page(&View::of(&graph(Content::default()))).unwrap());
}

#[test]
fn ids_beyond_the_digits_of_a_script_are_marked() {
    let mut graph = graph(Content::default());
    assert_eq!(data_of(&View::of(&graph))["edges"]["id"].get("wide"), None);
    let last = graph.edges.last_mut().unwrap();
    last.id = u64::MAX;
    assert_eq!(data_of(&View::of(&graph))["edges"]["id"]["wide"], "unsigned");
}

/// A field of its own on every edge, long lists, objects, long texts: the page stays small.
#[test]
fn many_and_large_fields_do_not_swell_a_page() {
    let mut graph = graph(Content::default());
    let plain = page(&View::of(&graph)).unwrap().len();
    for edge in &mut graph.edges {
        edge.extra.insert(format!("field_{}", edge.id), 1.into());
        edge.extra.insert("list".to_owned(), vec![0.5; 1000].into());
        edge.extra.insert("object".to_owned(), json!({"a": "b".repeat(1000)}));
        edge.extra.insert("text".to_owned(), "c".repeat(10_000).into());
    }
    let view = View::of(&graph);
    assert!(page(&view).unwrap().len() < plain + 20_000);
    assert!(data_of(&view)["edges"]["hidden"].as_u64().unwrap() >= 5);
}

#[test]
fn a_page_is_refused_in_a_sentence() {
    let main = graph(Content::default());
    let said = |view: &View| page(view).unwrap_err().to_string();
    let space = graph(Content { dimension: 3, ..Content::default() });
    assert!(said(&View { before: Some(&space), ..View::of(&main) }).contains("dimension 2 and 3"));
    let mut others = main.clone();
    for node in &mut others.nodes {
        node.id += 1000;
    }
    assert!(said(&View { before: Some(&others), ..View::of(&main) }).contains("no pose for any node"));
    let mut unsorted = main.clone();
    unsorted.edges.reverse();
    assert!(said(&View::of(&unsorted)).contains("sort the graph first"));
    assert!(page(&View::of(&PoseGraph::new(main.header.clone()))).is_ok());
}

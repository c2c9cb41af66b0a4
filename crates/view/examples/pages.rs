//! Writes pages with everything that a page can show, for the checks in a browser (scripts/check-view.sh).
//! Usage: cargo run -p posecut-view --example pages -- FOLDER

#![allow(clippy::unwrap_used, reason = "an example for tests")]

use std::path::Path;

use posecut_graph::PoseGraph;
use posecut_view::{Alternative, Remark, Severity, View, page};

#[path = "../tests/view/graphs.rs"]
mod graphs;

use graphs::{Content, graph, statistics};

fn remarks() -> Vec<Remark> {
    let remark = |severity, title: &str, text: &str, remedy: &str| Remark {
        severity,
        title: title.to_owned(),
        text: text.to_owned(),
        remedy: remedy.to_owned(),
    };
    vec![
        remark(Severity::Note, "Spacing of candidates", "Candidates of one pass are 4 frames apart.", ""),
        remark(
            Severity::Warning,
            "Same matrix for all edges",
            "All 105 edges have one information matrix, with standard deviations of 0.1 m and 2.9 degrees.",
            "Give landmark edges the covariances of your registration.",
        ),
    ]
}

fn main() {
    let folder = std::env::args().nth(1).expect("usage: pages FOLDER");
    let write = |name: &str, view: &View| {
        std::fs::write(Path::new(&folder).join(format!("{name}.html")), page(view).unwrap()).unwrap();
    };
    let (main, other) = (graph(Content::default()), graph(Content { hypothesis: 1, ..Content::default() }));
    let (statistics, remarks) = (statistics(), remarks());
    let alternatives = [Alternative { name: "hypothesis 1", graph: &other }];
    write(
        "hypotheses",
        &View {
            title: "Two laps",
            statistics: Some(&statistics),
            remarks: &remarks,
            alternatives: &alternatives,
            ..View::of(&main)
        },
    );
    let labelled = graph(Content { dimension: 3, labels: true, ..Content::default() });
    write("labels", &View { title: "Labels, in space", ..View::of(&labelled) });
    let apart = graph(Content { hypothesis: 2, ..Content::default() });
    write("apart", &View { title: "Components apart", ..View::of(&apart) });
    let without_poses = graph(Content { poses: false, ..Content::default() });
    write("poses", &View { title: "Without poses", ..View::of(&without_poses) });
    let name = "</script><script>alert('1')</script><!-- \"><img src=x onerror=alert(1)> {{data}}";
    // Ids with more digits than a script counts, as gtsam makes them.
    let mut hostile = graph(Content { sessions: [name, "b"], ..Content::default() });
    for node in &mut hostile.nodes {
        node.id += 1 << 60;
    }
    for edge in &mut hostile.edges {
        (edge.id, edge.from, edge.to) = (edge.id + (1 << 60), edge.from + (1 << 60), edge.to + (1 << 60));
        let witnesses = edge.extra.get_mut("verify_witness").and_then(|list| list.as_array_mut());
        for witness in witnesses.into_iter().flatten() {
            *witness = (witness.as_u64().unwrap() + (1 << 60)).into();
        }
    }
    write("hostile", &View { title: name, ..View::of(&hostile) });
    write("empty", &View { title: "Empty", ..View::of(&PoseGraph::new(main.header.clone())) });
}

//! Tests that the documents about the programs equal their generated documentation.

use std::collections::BTreeSet;

use posecut_contract::registry::programs;
use posecut_contract::{program, run, samples, succeed, workspace};
use posecut_graph::schema;
use xtask::documentation::{generated, pages};

#[test]
fn documents_are_current() {
    let stale: Vec<String> = pages(&programs(), program, &schema())
        .unwrap()
        .iter()
        .filter(|page| !page.is_current())
        .map(|page| page.path.display().to_string())
        .collect();
    assert!(
        stale.is_empty(),
        "out of date: {}; run `make documentation` and commit the result",
        stale.join(", ")
    );
}

/// Every field that a stage adds to the sample is on the page of fields.
#[test]
fn the_page_of_fields_has_the_fields_that_stages_add() {
    let page = std::fs::read_to_string(workspace().join("docs/fields.md")).unwrap();
    let sample = samples().bytes("graph.jsonl");
    let input = posecut_graph::PoseGraph::read("sample", sample.as_slice()).unwrap();
    let given: BTreeSet<String> = fields(&input);
    let mut added = BTreeSet::new();
    for (stage, arguments) in [
        ("verify", &[][..]),
        ("pcm", &["--chance", "3"]),
        ("multicut", &[]),
        ("optimize", &["--marginals", "all"]),
        ("optimize", &["--gnc"]),
    ] {
        let output = succeed(stage, arguments, &sample);
        added.extend(fields(&posecut_graph::PoseGraph::read(stage, output.as_slice()).unwrap()));
    }
    let marginals = samples().bytes("marginals.jsonl");
    let readmitted = succeed("readmit", &[], &marginals);
    added.extend(fields(&posecut_graph::PoseGraph::read("readmit", readmitted.as_slice()).unwrap()));
    let added: Vec<&String> = added.difference(&given).collect();
    assert!(added.len() > 10, "{added:?}");
    let missing: Vec<&&String> =
        added.iter().filter(|field| !page.contains(&format!("| `{field}` |"))).collect();
    assert!(missing.is_empty(), "docs/fields.md lacks {missing:?}");
}

/// The fields of the nodes and edges that the format does not define.
fn fields(graph: &posecut_graph::PoseGraph) -> BTreeSet<String> {
    let edges = graph.edges.iter().flat_map(|edge| edge.extra.keys());
    graph.nodes.iter().flat_map(|node| node.extra.keys()).chain(edges).cloned().collect()
}

#[test]
fn every_program_has_a_manual_page_and_completions_that_know_its_options() {
    for name in programs() {
        let manual = generated(&program(&name), "man").unwrap();
        assert!(manual.contains(".TH posecut-") && manual.contains("\\-\\-stats"), "{name}: {manual}");
        for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
            let completions = generated(&program(&name), shell).unwrap();
            assert!(
                completions.contains(&format!("posecut-{name}")) && completions.contains("stats"),
                "{name}: {shell}"
            );
        }
    }
}

#[test]
fn subcommands_have_their_options_in_the_manual() {
    let manual = generated(&program("report"), "man").unwrap();
    assert!(manual.contains(".SH \"TABLE: OPTIONS\"") && manual.contains("\\-\\-published"), "{manual}");
}

#[test]
fn what_cannot_be_generated_is_refused() {
    let output = run("pcm", &["--generate", "poem"], b"");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("\"poem\" is unknown") && said.contains("zsh"), "{said}");
}

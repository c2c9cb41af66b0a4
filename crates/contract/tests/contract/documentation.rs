//! Tests that the documents about the programs equal their generated documentation.

use posecut_contract::registry::programs;
use posecut_contract::{program, run};
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

//! Tests that the documents about the programs equal their generated documentation.

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::Path;
use std::process::Command;

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

/// Each shell loads the completions of every program and says what it would complete. A script that only looks right would pass the
/// test above.
#[test]
fn shells_load_the_completions() {
    let folder = tempfile::tempdir().unwrap();
    for (shell, script) in [
        // Bash and zsh say which function completes; bash also runs it, as after `posecut-pcm --stat` and a tab.
        (
            "bash",
            "source \"$1\" && registered=$(complete -p \"$2\") && function=${registered#*-F } && COMP_WORDS=(\"$2\" --stat) COMP_CWORD=1 && \
             ${function%% *} \"$2\" --stat \"$2\" && printf '%s\\n' \"${COMPREPLY[@]}\"",
        ),
        (
            "zsh",
            "autoload -Uz compinit && compinit -D -u && source \"$1\" && [[ -n ${_comps[$2]} ]] && which \"${_comps[$2]}\"",
        ),
        ("fish", "source $argv[1]; and complete -C \"$argv[2] --stat\""),
    ] {
        if let Err(error) = Command::new(shell).arg("--version").output()
            && error.kind() == ErrorKind::NotFound
        {
            println!("skipped: {shell} is not installed: its completions");
            continue;
        }
        for name in programs() {
            let file = folder.path().join(format!("{name}.{shell}"));
            std::fs::write(&file, generated(&program(&name), shell).unwrap()).unwrap();
            let (status, said) = loaded(shell, script, &file, &format!("posecut-{name}"));
            assert!(status && said.contains("--stats"), "{shell} does not complete posecut-{name}: {said}");
        }
    }
}

/// Whether a shell without the user's settings runs a script with these two arguments, and what it prints.
fn loaded(shell: &str, script: &str, file: &Path, program: &str) -> (bool, String) {
    let (settings, name) = match shell {
        "bash" => (&["--noprofile", "--norc"][..], Some("bash")),
        "zsh" => (&["-f"][..], Some("zsh")),
        _ => (&["--no-config"][..], None),
    };
    // Bash and zsh take the first argument after the script as their own name.
    let output = Command::new(shell)
        .args(settings)
        .args(["-c", script])
        .args(name)
        .arg(file)
        .arg(program)
        .output()
        .unwrap();
    let said = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8_lossy(&said).into_owned())
}

#[test]
fn manual_pages_list_the_values_of_options() {
    let manual = generated(&program("convert"), "man").unwrap();
    for value in ["g2o", "jrl", "consecutive", "next\\-id"] {
        assert!(manual.contains(&format!("\n{value}: ")), "{value}: {manual}");
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

//! Tests that no program writes two of its outputs to one file.

use posecut_contract::{run, samples};

/// Regression: the graph and the consistency graph silently overwrote each other.
#[test]
fn files_beside_the_result_may_be_neither_it_nor_the_statistics() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("same.json");
    let (file, spelt_otherwise) = (file.to_str().unwrap(), folder.path().join(".").join("same.json"));
    let (graph, instance) = (samples().path("graph.jsonl"), samples().path("four.mc"));
    let commands: [(&str, &[&str], &[&str]); 4] = [
        ("pcm", &[&graph], &["--consistency-graph"]),
        ("multicut", &[&graph], &["--certificate"]),
        ("isam", &[&graph], &["--every", "50", "--estimates"]),
        ("partition", &["solve", &instance], &["--certificate"]),
    ];
    for (name, input, options) in commands {
        for other in ["--output", "--stats"] {
            let mut arguments = [input, &[other, file]].concat();
            arguments.extend(options);
            arguments.push(spelt_otherwise.to_str().unwrap());
            let output = run(name, &arguments, b"");
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{name} {other}: {said}");
            assert!(said.contains("overwrite"), "{name} {other}: {said}");
            assert!(!std::path::Path::new(file).exists(), "{name} {other}");
        }
        let dash = run(name, &[input, options, &["-"]].concat(), b"");
        assert_eq!(dash.status.code(), Some(2), "{name}");
        // Regression: the program noticed that it could not write the file only after the work, when the summary was printed.
        let here = folder.path().to_str().unwrap();
        let into_folder = run(name, &[input, options, &[here]].concat(), b"");
        let said = String::from_utf8_lossy(&into_folder.stderr);
        assert_eq!(into_folder.status.code(), Some(2), "{name}: {said}");
        assert!(said.contains("is a folder") && said.lines().count() == 1, "{name}: {said}");
    }
}

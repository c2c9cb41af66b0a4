//! The page of a run.

use std::path::Path;

use serde_json::Value;

use crate::{clean, laps, only, stderr};

const WRONG: [(usize, usize); 3] = [(3, 18), (25, 95), (60, 7)];

/// Cleans a graph with a page, and returns the page with its data.
fn page(folder: &Path, graph: &str, arguments: &[&str]) -> (String, Value) {
    std::fs::write(folder.join("map.g2o"), graph).unwrap();
    let output =
        clean(folder, &[&["map.g2o", "-o", "out.g2o", "--page", "page.html"][..], arguments].concat());
    assert!(matches!(output.status.code(), Some(0 | 3)), "{}", stderr(&output));
    let text = std::fs::read_to_string(folder.join("page.html")).unwrap();
    let start = text.find("id=\"data\"").unwrap();
    let start = start + text[start..].find('>').unwrap() + 1;
    let end = start + text[start..].find("</script").unwrap();
    let data = serde_json::from_str(&text[start..end]).unwrap();
    (text, data)
}

fn names(states: &Value) -> Vec<&str> {
    states.as_array().unwrap().iter().map(|state| state["name"].as_str().unwrap()).collect()
}

#[test]
fn a_page_has_both_maps_and_the_verdicts_with_their_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let (text, data) = page(folder.path(), &laps(&WRONG), &[]);
    assert!(text.trim_end().ends_with("</html>"));
    assert!(text.contains("<title>map.g2o</title>"));
    assert_eq!(data["edges"]["count"], 43);
    assert_eq!(data["before"]["reckoned"], false, "the poses before are those of the input");
    let map = &data["maps"][0];
    assert_eq!(
        (names(&map["states"]), &map["optimised"]),
        (vec!["in use", "rejected by verify"], &true.into())
    );
    let reasons =
        map["columns"].as_array().unwrap().iter().find(|one| one["name"] == "verify_reason").unwrap();
    assert_eq!(reasons["words"]["words"], serde_json::json!(["supported", "contradicted"]));
    assert!(map["witnesses"].is_object());
    assert_eq!(data["verification"]["calibration"]["chains"].as_array().unwrap().len(), 1);
    // The history ends with this run.
    assert_eq!(data["stages"].as_array().unwrap().last().unwrap()["name"], "clean");
}

#[test]
fn a_page_says_what_doctor_finds() {
    let folder = tempfile::tempdir().unwrap();
    let (_, data) = page(folder.path(), &laps(&WRONG), &["--stats", "stats.json"]);
    let remarks = data["remarks"].as_array().unwrap();
    let title = "the covariances do not fit the loops";
    let fit = remarks.iter().find(|one| one["title"].as_str().unwrap().starts_with(title)).unwrap();
    assert_eq!(fit["severity"], "warning");
    assert!(fit["text"].as_str().unwrap().starts_with("Covariances are too large"), "{fit}");
    assert!(!fit["remedy"].as_str().unwrap().is_empty(), "{fit}");
    // The summary and the statistics have it too, and no note.
    let output = clean(folder.path(), &["map.g2o", "-o", "out.g2o"]);
    let said = stderr(&output);
    assert!(said.contains(&format!("doubtful   {title}")), "{said}");
    assert!(said.contains("and 1 other problem; posecut doctor lists them, with remedies"), "{said}");
    let stats: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("stats.json")).unwrap()).unwrap();
    assert_eq!(stats["findings"], serde_json::json!(["spacing", "calibration"]));
}

/// Regression: a legend called edges correct that nobody had labelled, and no page could be made without ground truth.
#[test]
fn without_labels_a_page_is_made_and_calls_no_edge_correct() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [&["--method", "verify"][..], &["--method", "none"], &["--undecided", "keep"]] {
        let (text, data) = page(folder.path(), &laps(&WRONG), arguments);
        assert_eq!(data["edges"]["label"], Value::Null);
        for name in names(&data["maps"][0]["states"]) {
            assert!(["in use", "rejected by verify", "undecided (in use)"].contains(&name), "{name}");
        }
        // Findings explain what methods do to correct and to wrong edges; everything else must not contain the word.
        let remarks = data["remarks"].to_string();
        let words = |text: &str| text.matches("correct").count();
        assert_eq!(words(&text), words(&remarks), "{arguments:?}");
    }
}

#[test]
fn without_poses_the_map_before_is_dead_reckoning() {
    let folder = tempfile::tempdir().unwrap();
    let edges = only(&laps(&WRONG), |line| line.starts_with("EDGE"));
    let (_, data) = page(folder.path(), &edges, &[]);
    assert_eq!(data["before"]["reckoned"], true);
    assert!(data["maps"][0]["positions"].is_object());
}

#[test]
fn another_method_is_named_in_the_legend() {
    let folder = tempfile::tempdir().unwrap();
    let (_, data) = page(folder.path(), &laps(&WRONG), &["--method", "none"]);
    assert_eq!(names(&data["maps"][0]["states"]), ["in use"]);
    assert_eq!(data["verification"], Value::Null);
}

#[test]
fn the_summary_names_the_page_and_the_same_run_writes_the_same_page() {
    let folder = tempfile::tempdir().unwrap();
    let (first, _) = page(folder.path(), &laps(&WRONG), &[]);
    let output = clean(folder.path(), &["map.g2o", "-o", "out.g2o", "--page", "page.html"]);
    assert!(stderr(&output).contains("page.html (the page: open it in a browser)"), "{}", stderr(&output));
    assert!(first == std::fs::read_to_string(folder.path().join("page.html")).unwrap());
}

#[test]
fn a_page_replaces_no_other_file_and_is_whole_or_not_there() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.g2o"), laps(&[])).unwrap();
    for (arguments, sentence) in [
        (vec!["--page", "map.g2o"], "name two files"),
        (vec!["--page", "out.g2o"], "name two files"),
        (vec!["--page", "x", "--edges", "x"], "name two files"),
        (vec!["--page", "x", "--stats", "x"], "name two files"),
        (vec!["--page", "-"], "--page cannot be -"),
        (vec!["--page", "."], "is a folder"),
        (vec!["--page", "nowhere/page.html"], "nowhere"),
    ] {
        let output = clean(folder.path(), &[&["map.g2o", "-o", "out.g2o"][..], &arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(sentence), "{arguments:?}: {}", stderr(&output));
        let files: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().file_name()).collect();
        assert_eq!(files, ["map.g2o"], "{arguments:?}");
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("map.g2o")).unwrap(), laps(&[]));
}

/// Two sessions that two groups of edges join in two ways: the page can switch between both maps.
#[test]
fn rival_hypotheses_are_maps_to_switch_to() {
    let folder = tempfile::tempdir().unwrap();
    let (_, data) = page(folder.path(), &two_ways(), &[]);
    let maps = data["maps"].as_array().unwrap();
    assert_eq!(maps.len(), 2, "{}", data["verification"]["rivals"]);
    let rival = &data["verification"]["rivals"][0]["hypothesis"];
    assert_eq!(maps[1]["name"], format!("hypothesis {}", rival.as_f64().unwrap()));
    assert_ne!(maps[0]["state"], maps[1]["state"]);
    assert_ne!(maps[0]["positions"], maps[1]["positions"]);
    // Where the rival is applied, the map is the alternative.
    let number = format!("{}", rival.as_f64().unwrap());
    let (_, applied) = page(folder.path(), &two_ways(), &["--hypothesis", &number]);
    assert_eq!(applied["maps"][1]["name"], "main map");
}

/// Two straight walks of 40 poses. Seven edges say that they begin together, six others that the second begins 20 m later.
fn two_ways() -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    for node in 0..80 {
        let (x, y) = (node % 40, if node < 40 { 0 } else { 3 });
        writeln!(text, "VERTEX_SE2 {node} {x} {y} 0").unwrap();
    }
    for node in (1..80).filter(|node| *node != 40) {
        let error = 0.02 * (1.7 * f64::from(node)).sin();
        writeln!(text, "EDGE_SE2 {} {node} {} {error} 0 1000 0 0 1000 0 40000", node - 1, 1.0 + error)
            .unwrap();
    }
    for step in 0..7 {
        let error = 0.03 * f64::from(step).sin();
        writeln!(text, "EDGE_SE2 {} {} {error} {error} 0 1000 0 0 1000 0 10000", 2 * step, 40 + 2 * step)
            .unwrap();
    }
    for step in 0..6 {
        let error = 0.03 * (2.0 * f64::from(step)).cos();
        writeln!(
            text,
            "EDGE_SE2 {} {} {error} {error} 0 1000 0 0 1000 0 10000",
            20 + 2 * step,
            40 + 2 * step
        )
        .unwrap();
    }
    text
}

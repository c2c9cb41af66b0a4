//! The cases of posecut-report, on hand-made results of the trust benchmark and of regimes.

use std::fmt::Write as _;
use std::path::Path;

use super::cases::{Case, old_outputs, words};

/// Results and times of two methods on both halves of a benchmark. The methods give probabilities of edges.
fn trust(folder: &Path) {
    let (mut results, mut times) = (String::new(), String::new());
    for (half, family) in [("test", "f"), ("tuning", "g")] {
        for (cluster, method, rmse) in [("a", "one", 1), ("a", "two", 2), ("b", "one", 1), ("b", "two", 2)] {
            let labels = format!(
                r#"{{"pipeline":"trust","family":"{family}","half":"{half}","cluster":"{cluster}","session":"{family} {cluster}","seed":1,"method":"{method}"}}"#
            );
            let _ = writeln!(
                results,
                r#"{{"format":"posecut-result","version":1,"labels":{labels},"rmse":{rmse},"components":1,"poses":10,"poses_unmatched":0,"calibration":{{"edges":[0,0,0,0,0,0,0,0,10,100],"probability":[0,0,0,0,0,0,0,0,8.5,98],"correct":[0,0,0,0,0,0,0,0,7,100]}},"edges":{{"true_positive":8,"false_positive":1,"false_negative":2,"true_negative":0,"precision":null,"recall":null}}}}"#
            );
            let _ = writeln!(times, r#"{{"labels":{labels},"cpu_seconds":{rmse}}}"#);
        }
    }
    // A page of the repository has every section, also those to come.
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/results/drawn.md");
    let page = std::fs::read_to_string(page).unwrap();
    for (name, text) in
        [("r.jsonl", results), ("t.jsonl", times), ("d.md", page), ("s.md", document(&["trust"]))]
    {
        std::fs::write(folder.join(name), text).unwrap();
    }
    old_outputs(folder);
}

/// Two methods at two scales and two rates.
fn regimes(folder: &Path) {
    let mut text = String::new();
    for (method, rmse) in [("pcm", 2), ("pcm+gc", 1)] {
        for (scale, rate) in [(1, 0.1), (1, 0.2), (3, 0.1), (3, 0.2)] {
            let _ = writeln!(
                text,
                r#"{{"format":"posecut-result","version":1,"labels":{{"session":"s","method":"{method}","seed":1,"covariance_scale":{scale},"incorrect_rate":{rate},"incorrect_kind":"uniform"}},"rmse":{rmse},"components":1,"edges":{{"true_positive":9,"false_positive":1,"false_negative":3,"true_negative":2}}}}"#
            );
        }
    }
    std::fs::write(folder.join("r.jsonl"), text).unwrap();
    std::fs::write(folder.join("d.md"), document(&["verdict", "uniform", "kinds", "edges"])).unwrap();
    old_outputs(folder);
}

/// A document with a place for each section.
fn document(names: &[&str]) -> String {
    names.iter().flat_map(|name| ["<!-- begin: ", name, " -->\n<!-- end: ", name, " -->\n"]).collect()
}

pub(super) fn reports() -> Vec<Case> {
    let case = |task: &str, prepare, more: &[&str], names: &[&str]| {
        let all = [&[task, "r.jsonl"], more].concat();
        Case::new("report", &words(&all), prepare).naming(names)
    };
    let ends = ["-o", "out", "--stats", "stats.json"];
    let trusted = ["--times", "t.jsonl", "--figure", "f.svg", "--reliability", "p.png"];
    let documents = ["--document", "d.md", "--summary", "s.md"];
    let mut drawn = case(
        "trust",
        trust,
        &[&trusted[..], &documents, &ends].concat(),
        &["f.svg", "p.png", "d.md", "s.md", "out", "stats.json"],
    );
    // Each run draws two figures.
    drawn.most /= 2;
    vec![
        drawn,
        case("trust", trust, &documents, &["d.md", "s.md", "standard output"]),
        case("regimes", regimes, &["-o", "map.svg", "--stats", "stats.json"], &["map.svg", "stats.json"]),
        case("regimes", regimes, &["-o", "map.png"], &["map.png"]),
        case("regimes", regimes, &["--table", "csv", "-o", "out"], &["out"]),
        case("regimes", regimes, &["--document", "d.md"], &["d.md", "standard output"]),
    ]
}

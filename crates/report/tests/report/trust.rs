//! Tests the trust benchmark with hand-made results.

mod bad_input;
mod calibration;
mod doubts;
mod examples;
mod joined;
mod program;
mod properties;

use posecut_report::trust::Benchmark;
use posecut_report::trust::records::read_results;
use std::fs;

/// A run: half, family, cluster, seed.
type Place<'a> = (&'a str, &'a str, &'a str, u32);

fn labels((half, family, cluster, seed): Place, method: &str) -> String {
    format!(
        r#"{{"pipeline":"trust","family":"{family}","half":"{half}","cluster":"{cluster}","session":"{family} {cluster}","seed":{seed},"method":"{method}"}}"#
    )
}

/// A result: correct edges kept and lost, and false edges kept.
fn done(place: Place, method: &str, rmse: f64, [kept, lost, wrong]: [u32; 3]) -> String {
    format!(
        r#"{{"format":"posecut-result","version":1,"labels":{},"rmse":{rmse},"components":1,"poses":10,"poses_unmatched":0,"edges":{{"true_positive":{kept},"false_positive":{wrong},"false_negative":{lost},"true_negative":0,"precision":null,"recall":null}}}}"#,
        labels(place, method)
    ) + "\n"
}

fn failed(place: Place, method: &str) -> String {
    format!(
        r#"{{"format":"posecut-result","version":1,"labels":{},"failed":"{method}: stopped at 60 CPU seconds"}}"#,
        labels(place, method)
    ) + "\n"
}

fn read(lines: &str) -> anyhow::Result<Benchmark> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.jsonl");
    fs::write(&path, lines).unwrap();
    Benchmark::new(&read_results(&path)?.0, None)
}

/// The error message for these lines, without the folder.
fn refused(lines: &str) -> String {
    let said = format!("{:#}", read(lines).unwrap_err());
    said.split_once("results.jsonl").map_or(said.clone(), |(_, rest)| format!("results.jsonl{rest}"))
}

/// Five test runs of three clusters: `one` fails on one of them, `two` is missing on another.
fn sample(half: &str) -> String {
    let place = |cluster, seed| (half, "f", cluster, seed);
    [
        done(place("a", 1), "one", 1.0, [8, 2, 0]),
        done(place("a", 1), "two", 2.0, [8, 2, 1]),
        done(place("a", 2), "one", 5.0, [5, 5, 3]),
        done(place("a", 2), "two", 1.0, [10, 0, 0]),
        failed(place("b", 1), "one"),
        done(place("b", 1), "two", 0.5, [1, 9, 0]),
        done(place("b", 2), "one", 1.15, [10, 0, 0]),
        done(place("b", 2), "two", 1.0, [10, 0, 0]),
        done(place("c", 1), "one", 0.3, [1, 0, 0]),
        // The oracle is the best everywhere, but no method is compared with it.
        done(place("a", 1), "oracle", 0.0, [10, 0, 0]),
    ]
    .concat()
}

/// The record of `two` that the sample lacks in the tuning half.
fn filled() -> String {
    done(("tuning", "f", "c", 1), "two", 0.3, [1, 0, 0]).replace("\"f c\"", "\"tuned c\"")
}

/// A result with a calibration record: for each of the last two bins the edges, the sum of probabilities and the
/// correct edges.
fn judged(place: Place, method: &str, bins: [(u32, f64, u32); 2]) -> String {
    let [(few, low, right), (many, high, correct)] = bins;
    let zeros = "0,0,0,0,0,0,0,0";
    done(place, method, 1.0, [1, 0, 0]).replace(
        ",\"edges\":",
        &format!(
            ",\"calibration\":{{\"edges\":[{zeros},{few},{many}],\"probability\":[{zeros},{low},{high}],\"correct\":[{zeros},{right},{correct}]}},\"edges\":"
        ),
    )
}

/// Three runs of two families with a calibration record, and two runs without: one of another method, one without
/// probabilities.
fn probabilities() -> String {
    [
        judged(("test", "f", "a", 1), "judge", [(10, 8.5, 7), (100, 98.0, 100)]),
        judged(("test", "f", "b", 1), "judge", [(10, 8.1, 9), (0, 0.0, 0)]),
        judged(("test", "g", "a", 1), "judge", [(0, 0.0, 0), (80, 80.0, 72)]),
        done(("test", "g", "b", 1), "judge", 1.0, [1, 0, 0]),
        done(("test", "f", "a", 1), "other", 1.0, [1, 0, 0]),
    ]
    .concat()
}

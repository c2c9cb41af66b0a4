//! Records that are refused, and different records that look similar.

use posecut_report::trust::records::{read_results, read_times};
use posecut_report::trust::summary::summary;
use posecut_report::trust::tables::{Table, tables};
use posecut_report::trust::{Benchmark, Half};
use std::fs;

use super::{done, failed, labels, read, refused, sample};

#[test]
fn bad_input_is_refused_with_file_line_and_field() {
    let place = ("test", "f", "a", 1);
    let good = done(place, "one", 1.0, [1, 0, 0]);
    for (bad, parts) in [
        (good.replace("\"half\":\"test\",", ""), ["results.jsonl, line 2", "label `half`: is missing"]),
        (good.replace("\"family\":\"f\",", ""), ["results.jsonl, line 2", "label `family`: is missing"]),
        (
            good.replace("\"cluster\":\"a\"", "\"cluster\":\"\""),
            ["line 2", "label `cluster`: is missing or empty"],
        ),
        (good.replace("\"seed\":1,", ""), ["line 2", "label `seed`: is missing"]),
        (good.replace("\"method\":\"one\"", "\"method\":[]"), ["line 2", "label `method`: found []"]),
        (
            good.replace("\"half\":\"test\"", "\"half\":\"both\""),
            ["line 2", "found \"both\", expected \"tuning\" or \"test\""],
        ),
        (good.replace("\"rmse\":1", "\"rmse\":NaN"), ["line 2", "is not a JSON object"]),
        (
            good.replace("\"rmse\":1", "\"rmse\":null"),
            ["line 2", "field `rmse`: found null, expected a finite number"],
        ),
        (good.replace("\"rmse\":1", "\"rmse\":-1"), ["line 2", "field `rmse`: found -1"]),
        (good.replace("\"rmse\":1,", ""), ["line 2", "field `rmse`: is missing"]),
        (good.replace("\"components\":1,", ""), ["line 2", "field `components`: is missing"]),
        (
            good.replace("\"false_positive\":0", "\"false_positive\":0.5"),
            ["in field `edges`", "field `false_positive`: found 0.5"],
        ),
        (good.replace("\"rmse\":1", "\"failed\":\"x\",\"rmse\":1"), ["line 2", "a failed run has no RMSE"]),
        (
            failed(place, "one").replace("one: stopped at 60 CPU seconds", " "),
            ["line 2", "field `failed`: found"],
        ),
        (
            good.replace("posecut-result", "posecut"),
            ["line 2", "found posecut, 1, expected posecut-result, 1"],
        ),
        ("[1]\n".to_owned(), ["line 2", "is not a JSON object"]),
        (
            good.clone(),
            ["line 3", "method one has a second result on the run pipeline trust, seed 1, session f a"],
        ),
        (
            good.replace("\"half\":\"test\"", "\"half\":\"tuning\"").replace("\"one\"", "\"two\""),
            [
                "label `half` of the run pipeline trust, seed 1, session f a is \"test\", and",
                "line 2 has \"tuning\" for the same run",
            ],
        ),
    ] {
        // The first line belongs to another method. A blank line precedes the record where line 3 is expected.
        let first = done(place, "zero", 1.0, [1, 0, 0]);
        let said = if bad == good {
            refused(&format!("{first}{good}{bad}"))
        } else {
            refused(&format!("{first}{bad}"))
        };
        for part in parts {
            assert!(said.contains(part), "{part}\n{said}");
        }
        assert!(!said.contains('\n'), "{said}");
    }
    let said = refused("");
    assert!(said.contains("no method except the oracle has a result"), "{said}");
}

#[test]
fn a_real_and_a_simulated_session_of_one_date_are_two_clusters() {
    let real = done(("test", "f", "2012-08-04", 1), "one", 1.0, [1, 0, 0]);
    let simulated = real.replace("\"pipeline\":\"trust\"", "\"pipeline\":\"trust-simulated\"");
    let benchmark = read(&(real + &simulated)).unwrap();
    assert!(summary(&benchmark, Half::Test, None, 0).share.unwrap().interval.is_some());
}

#[test]
fn times_belong_to_results() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("times.jsonl");
    let place = ("test", "f", "a", 1);
    let records = {
        let path = folder.path().join("results.jsonl");
        fs::write(&path, sample("test")).unwrap();
        read_results(&path).unwrap().0
    };
    let time = |method: &str, seconds: &str| {
        // Families and halves are not needed to tell runs apart, and a seed may be text.
        let labels =
            labels(place, method).replace("\"family\":\"f\",\"half\":\"test\",\"cluster\":\"a\",", "");
        format!(
            "{{\"labels\":{},\"cpu_seconds\":{seconds}}}\n",
            labels.replace("\"seed\":1", "\"seed\":\"1\"")
        )
    };
    let made = |lines: String| {
        fs::write(&path, lines).unwrap();
        Benchmark::new(&records, Some(&read_times(&path)?.0))
    };
    let benchmark = made(time("one", "1.5") + &time("two", "0.25")).unwrap();
    assert_eq!(summary(&benchmark, Half::Test, None, 0).seconds, [1.5]);
    let text: String = tables(&benchmark, Half::Test).iter().map(Table::markdown).collect();
    assert!(text.contains("1 of 5") && text.contains("1.50") && text.contains("0.25"), "{text}");
    for (lines, part) in [
        (time("one", "-1"), "line 1: field `cpu_seconds`: found -1"),
        (time("one", "1") + &time("one", "1"), "line 2: method one has a second time"),
        (time("three", "1"), "line 1: there is no result of method three"),
    ] {
        let said = format!("{:#}", made(lines).unwrap_err());
        assert!(said.contains(part), "{part}\n{said}");
    }
}

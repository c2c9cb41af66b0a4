//! The trust benchmark against hand-made results.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use posecut_report::figure::plotting::{charts, lanes};
use posecut_report::figure::regret::{figure, position, regrets};
use posecut_report::figure::reliability::figure as diagram;
use posecut_report::regimes::document::splice;
use posecut_report::trust::document::sections;
use posecut_report::trust::recommendation::{answer, recommended};
use posecut_report::trust::records::{read_results, read_times};
use posecut_report::trust::reliability::{ALL, reliability, sentence};
use posecut_report::trust::summary::summary;
use posecut_report::trust::tables::{Table, calibration, failures, overall, tables};
use posecut_report::trust::{Benchmark, Half};
use proptest::prelude::*;

/// A run: half, family, cluster, seed.
type Place<'a> = (&'a str, &'a str, &'a str, u32);

fn labels((half, family, cluster, seed): Place, method: &str) -> String {
    format!(
        r#"{{"pipeline":"trust","family":"{family}","half":"{half}","cluster":"{cluster}","session":"{family} {cluster}","seed":{seed},"method":"{method}"}}"#
    )
}

/// Correct edges kept and lost, false edges kept.
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

/// What is wrong with the lines, in one sentence, without the folder.
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
        // The oracle is the best everywhere, and compared with nobody.
        done(place("a", 1), "oracle", 0.0, [10, 0, 0]),
    ]
    .concat()
}

#[test]
fn an_example_by_hand() {
    let benchmark = read(&sample("test")).unwrap();
    assert_eq!(
        (benchmark.methods.as_slice(), benchmark.runs.len()),
        (["one", "two"].map(String::from).as_slice(), 5)
    );
    let close = |estimate: Option<posecut_report::trust::summary::Estimate>, value: f64| {
        assert!((estimate.unwrap().value - value).abs() < 1e-12, "{estimate:?} {value}");
    };
    let one = summary(&benchmark, Half::Test, Some("f"), 0);
    assert_eq!((one.runs, one.failed, one.missing, one.done()), (5, 1, 0, 4));
    // RMSE 0.3, 1, 1.15, 5; regret 0, 0, 0.15, 4.
    close(one.mean, 7.45 / 4.0);
    assert_eq!((one.median, one.worst), (Some(1.075), Some(5.0)));
    close(one.regret, 4.15 / 4.0);
    assert_eq!((one.worst_regret, one.large_regrets, one.with_false), (Some(4.0), 0, 1));
    close(one.recall, 24.0 / 31.0);
    // 1.15 m is within 1.1 x 1 m + 0.1 m; 5 m is not, nor is the failed run.
    assert_eq!(one.within, 3);
    close(one.share, 0.6);
    let two = summary(&benchmark, Half::Test, None, 1);
    assert_eq!((two.runs, two.failed, two.missing, two.within), (5, 0, 1, 3));
    close(two.regret, 0.25);
    close(two.recall, 29.0 / 40.0);
}

#[test]
fn failed_and_missing_runs_are_in_every_table_and_in_the_figure() {
    let benchmark = read(&sample("test")).unwrap();
    let text = overall(&benchmark, Half::Test).markdown();
    assert!(text.contains("4 of 5 (1 failed)") && text.contains("4 of 5 (1 missing)"), "{text}");
    let text: String = tables(&benchmark, Half::Test).iter().map(Table::markdown).collect();
    assert_eq!(text.matches("4 of 5 (1 failed)").count(), 2, "over all families and in its own\n{text}");
    let text = failures(&benchmark, Half::Test).markdown();
    assert!(text.contains("one: stopped at 60 CPU seconds"), "{text}");
    assert!(text.contains("missing: there is no record of it"), "{text}");
    let shown = figure(&regrets(&benchmark, Half::Test));
    let crossed: Vec<usize> = shown.panels[0].lanes.iter().map(|lane| lane.crossed).collect();
    assert_eq!(crossed, [1, 1]);
    let dots: Vec<usize> = shown.panels[0].lanes.iter().map(|lane| lane.dots.len()).collect();
    assert_eq!(dots, [4, 4], "one dot a finished run");
    let marked = shown.panels[0].lanes.iter().flat_map(|lane| &lane.dots).filter(|dot| dot.marked).count();
    assert_eq!(marked, 2, "runs with a false edge are told apart");
    assert!(position(0.0, 10.0) == 0.0 && (position(10.0, 10.0) - 1.0).abs() < 1e-12);
    for format in ["svg", "png"] {
        assert!(lanes(&shown, 3).unwrap().write(format).unwrap().len() > 1000);
    }
}

#[test]
fn the_tuning_half_chooses_and_the_test_half_reports() {
    let tuning = |cluster| ("tuning", "f", cluster, 1);
    let test = |family, seed| ("test", family, "z", seed);
    let text = [
        // `careful` is the best on two of three tuning runs, `bold` on one.
        done(tuning("a"), "careful", 0.0, [1, 0, 0]) + &done(tuning("a"), "bold", 9.0, [1, 0, 1]),
        done(tuning("b"), "careful", 0.0, [1, 0, 0]) + &done(tuning("b"), "bold", 9.0, [1, 0, 1]),
        done(tuning("c"), "careful", 9.0, [1, 0, 0]) + &done(tuning("c"), "bold", 0.0, [1, 0, 0]),
        // On the test half it is the other way round.
        done(test("f", 1), "careful", 7.0, [1, 0, 0]) + &done(test("f", 1), "bold", 0.0, [1, 0, 0]),
        done(test("f", 2), "careful", 2.0, [1, 0, 0]) + &done(test("f", 2), "bold", 0.0, [1, 0, 0]),
        done(test("g", 1), "careful", 1.0, [1, 0, 2]) + &done(test("g", 1), "bold", 1.0, [1, 0, 0]),
    ]
    .concat();
    let benchmark = read(&text).unwrap();
    assert_eq!(benchmark.methods[recommended(&benchmark).unwrap()], "careful");
    let said = answer(&benchmark).unwrap();
    for part in [
        "**Use `careful`.** Of the 2 methods",
        "67 %",
        "on 33 % of 3 runs, keeps a false edge in 1, and its worst regret is 7.00 m",
        "On the test half `bold` does better: 100 %.",
        "in 2 of 2 families",
        "- **f**: regret above 5 m in 1 of 2 runs (worst 7.00 m).",
        "- **g**: keeps a false edge in 1 of 1 run.",
        "Without any such mistake on the test half: `bold`.",
    ] {
        assert!(said.contains(part), "{part}\n{said}");
    }
    // A method with a gap in the tuning half cannot be chosen, however good it is on the rest.
    let gap = text.clone() + &done(tuning("a"), "lucky", 0.0, [1, 0, 0]);
    assert_eq!(benchmark.methods[recommended(&read(&gap).unwrap()).unwrap()], "careful");
    let said = answer(&read(&sample("test")).unwrap()).unwrap_err().to_string();
    assert!(said.contains("no run of the tuning half"), "{said}");
    let said = answer(&read(&sample("tuning")).unwrap()).unwrap_err().to_string();
    assert!(said.contains("no run of the test half"), "{said}");
    // `two` has no record of one run, and now `one` has none of another.
    let gaps = sample("tuning").replace(&failed(("tuning", "f", "b", 1), "one"), "");
    let said = answer(&read(&gaps).unwrap()).unwrap_err().to_string();
    assert!(said.contains("no method has a record for every run"), "{said}");
}

#[test]
fn the_document_of_the_repository_has_every_marker() {
    let text = sample("test") + &sample("tuning").replace("\"f ", "\"tuned ") + &filled();
    let benchmark = read(&text).unwrap();
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/trust.md");
    let mut document = fs::read_to_string(page).unwrap();
    for (name, section) in sections(&benchmark).unwrap() {
        document = splice(&document, name, &section).unwrap();
        assert!(document.contains(section.trim()), "{name}");
    }
    assert!(document.find("**Use `").unwrap() < 200, "the answer comes first");
}

/// `two` where the sample lacks it in the tuning half.
fn filled() -> String {
    done(("tuning", "f", "c", 1), "two", 0.3, [1, 0, 0]).replace("\"f c\"", "\"tuned c\"")
}

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
        (good.replace("\"rmse\":1", "\"rmse\":NaN"), ["line 2", "is no JSON object"]),
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
        ("[1]\n".to_owned(), ["line 2", "is no JSON object"]),
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
        // The first line is another method's, a blank line stands between where the place is line 3.
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
    assert!(said.contains("there is no result of any method"), "{said}");
}

/// A result with a calibration record: edges, sum of probability and correct edges of the last two bins.
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

/// Three runs of two families with a record, and two without: one of another method, one without probabilities.
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

#[test]
fn the_calibration_error_of_an_example_by_hand() {
    let found = reliability(&read(&probabilities()).unwrap(), Half::Test).unwrap();
    let names: Vec<&str> = found.groups.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, [ALL, "f", "g"]);
    assert!(found.groups.iter().all(|group| group.curves.len() == 1), "`other` has no probabilities");
    let [all, f, g] = [0, 1, 2].map(|group| &found.groups[group].curves[0]);
    assert_eq!(
        [(all.runs, all.of, all.edges), (f.runs, f.of, f.edges), (g.runs, g.of, g.edges)],
        [(3, 4, 200), (2, 2, 120), (1, 2, 80)]
    );
    // Bins are pooled before they are compared: 16 of 20 at 16.6, and 172 of 180 at 178.
    assert!((all.error - (0.6 + 6.0) / 200.0).abs() < 1e-12, "{}", all.error);
    assert!((f.error - (0.6 + 2.0) / 120.0).abs() < 1e-12, "{}", f.error);
    assert!((g.error - 8.0 / 80.0).abs() < 1e-12, "{}", g.error);
    let close = |value: f64, wanted: f64| assert!((value - wanted).abs() < 1e-12, "{value} {wanted}");
    close(all.points[0].probability, 0.83);
    close(all.points[0].correct, 0.8);
    close(all.points[1].correct, 172.0 / 180.0);
    assert_eq!((all.points[0].bin, all.points[1].bin, all.points[0].edges), (8, 9, 20));
    // Family f has two clusters with edges in bin 8, 7 of 10 and 9 of 10 correct.
    assert_eq!(all.points[0].interval, Some((0.7, 0.9)));

    let text: String = calibration(&found).iter().map(Table::markdown).collect();
    for part in
        ["| all families | 3 of 4 |", "0.0330", "0.1000", "| 0.8 to 0.9 |", "0.800 [0.700, 0.900]", "–"]
    {
        assert!(text.replace("  ", " ").replace("  ", " ").contains(part), "{part}\n{text}");
    }
    let said = sentence(Some(&found), Half::Test);
    assert_eq!(
        said,
        "The expected calibration error of `judge` on the test half is 0.0330, over 200 edges of 3 runs."
    );
    let panels = diagram(&found);
    assert_eq!(panels.len(), 3);
    assert_eq!(panels[0].lines[1].points.len(), 2);
    assert_eq!(panels[0].lines[1].legend.as_deref(), Some("judge: error 0.0330, 200 edges"));
    for format in ["svg", "png"] {
        assert!(charts(&panels, 3).unwrap().write(format).unwrap().len() > 1000);
    }
}

#[test]
fn without_records_of_calibration_there_is_nothing_to_report() {
    let benchmark = read(&sample("test")).unwrap();
    assert_eq!(reliability(&benchmark, Half::Test), None);
    let text: String = tables(&benchmark, Half::Test).iter().map(Table::markdown).collect();
    assert!(!text.contains("Calibration"), "{text}");
    // The record of another half says nothing of this one, nor does one without an edge.
    let tuning = read(&probabilities().replace("\"half\":\"test\"", "\"half\":\"tuning\"")).unwrap();
    assert_eq!(reliability(&tuning, Half::Test), None);
    assert!(reliability(&tuning, Half::Tuning).is_some());
    let empty = judged(("test", "f", "a", 1), "judge", [(0, 0.0, 0), (0, 0.0, 0)]);
    assert_eq!(reliability(&read(&empty).unwrap(), Half::Test), None);
    assert!(sentence(None, Half::Test).contains("No result of the test half has probabilities"));
}

#[test]
fn a_record_of_calibration_that_cannot_be_is_refused() {
    let place = ("test", "f", "a", 1);
    let good = judged(place, "judge", [(10, 8.5, 7), (100, 98.0, 100)]);
    for (bad, part) in [
        (
            good.replace("[0,0,0,0,0,0,0,0,7,100]", "[0,7,100]"),
            "field `correct`: found [0,7,100], expected 10 numbers",
        ),
        (
            good.replace(",7,100]", ",11,100]"),
            "field `correct`, bin 8: found 11, expected at most the 10 edges",
        ),
        (
            good.replace(",8.5,98", ",9.5,98"),
            "field `probability`, bin 8: found 9.5 over 10 edges, expected 0.8 to 0.9",
        ),
        (good.replace(",8.5,98", ",null,98"), "field `probability`: found"),
        (good.replace(",10,100]", ",10,-1]"), "field `edges`: found"),
        (good.replace("\"calibration\":{", "\"calibration\":[],\"was\":{"), "field `calibration`: found []"),
    ] {
        assert_ne!(bad, good);
        let said = refused(&bad);
        assert!(said.contains("line 1") && said.contains(part), "{part}\n{said}");
    }
    let none = good.replace("\"calibration\":{", "\"calibration\":null,\"was\":{");
    assert_eq!(reliability(&read(&none).unwrap(), Half::Test), None);
}

#[test]
fn the_program_draws_the_diagram_and_the_page_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("r.jsonl"), probabilities()).unwrap();
    for name in ["d.svg", "d.png"] {
        let (good, text, said) = run(&["trust", &path("r.jsonl"), "--reliability", &path(name)]);
        assert!(good && text.contains("### Calibration of probabilities, test half"), "{said}");
        assert!(fs::metadata(path(name)).unwrap().len() > 1000);
    }
    let (good, page, said) = run(&["html", "--trust", &path("r.jsonl")]);
    assert!(good, "{said}");
    assert!(page.contains("id=\"trust-reliability\"") && page.contains("\"reliability\":{\"half\":\"test\""));

    // Nothing to draw is no error, since a benchmark of other methods has no probabilities.
    fs::write(path("none.jsonl"), sample("test")).unwrap();
    let (good, _, said) = run(&["trust", &path("none.jsonl"), "--reliability", &path("none.svg")]);
    assert!(good && said.contains("none.svg is not written"), "{said}");
    assert!(!Path::new(&path("none.svg")).exists());
    let (_, page, _) = run(&["html", "--trust", &path("none.jsonl")]);
    assert!(!page.contains("id=\"trust-reliability\""));
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
        // Families and halves are not needed to tell runs apart; a seed may be text.
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

/// Two methods and a third that may fail, on up to three families, clusters and seeds.
fn any_lines() -> impl Strategy<Value = Vec<String>> {
    let run =
        (0..3_usize, 0..3_usize, prop::bool::ANY, prop::array::uniform3(0.0..100.0_f64), prop::bool::ANY);
    prop::collection::vec(run, 1..12).prop_map(|runs| {
        let mut lines = Vec::new();
        for (seed, (family, cluster, test, rmse, fails)) in runs.into_iter().enumerate() {
            let half = if test { "test" } else { "tuning" };
            let place =
                (half, ["f", "g", "h"][family], ["a", "b", "c"][cluster], u32::try_from(seed).unwrap());
            for (method, error) in ["one", "two", "three"].into_iter().zip(rmse) {
                if fails && method == "three" {
                    lines.push(failed(place, method));
                } else {
                    lines.push(done(
                        place,
                        method,
                        error,
                        [u32::try_from(seed).unwrap() % 4, 1, seed as u32 % 2],
                    ));
                }
            }
        }
        lines
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn regret_is_never_negative_and_the_best_has_none(lines in any_lines()) {
        let benchmark = read(&lines.concat()).unwrap();
        for run in &benchmark.runs {
            let regrets: Vec<f64> = (0..3).filter_map(|method| run.regret(method)).collect();
            prop_assert!(regrets.iter().all(|regret| *regret >= 0.0));
            prop_assert!(regrets.contains(&0.0));
            for method in 0..3 {
                prop_assert!(run.regret(method) != Some(0.0) || run.within(method), "the best is within the bound");
            }
        }
    }

    #[test]
    fn intervals_contain_what_they_are_of_or_are_absent(lines in any_lines()) {
        let benchmark = read(&lines.concat()).unwrap();
        for method in 0..benchmark.methods.len() {
            let own = summary(&benchmark, Half::Test, None, method);
            let clusters: std::collections::BTreeSet<_> =
                benchmark.of(Half::Test, None).map(|run| (&run.family, &run.cluster)).collect();
            let several = clusters.iter().any(|one| clusters.iter().any(|other| one.0 == other.0 && one.1 != other.1));
            if let Some(share) = own.share {
                prop_assert_eq!(share.interval.is_some(), several);
                if let Some((low, high)) = share.interval {
                    prop_assert!(0.0 <= low && low <= high && high <= 1.0);
                }
            }
        }
    }

    #[test]
    fn the_order_of_lines_changes_nothing(
        (lines, shuffled) in any_lines().prop_flat_map(|lines| (Just(lines.clone()), Just(lines).prop_shuffle()))
    ) {
        let all = |lines: &[String]| {
            let benchmark = read(&lines.concat()).unwrap();
            let half = benchmark.runs.iter().map(|run| run.half).max().unwrap();
            let text: String = tables(&benchmark, half).iter().map(Table::markdown).collect();
            let drawing = lanes(&figure(&regrets(&benchmark, half)), 3).unwrap().write("svg").unwrap();
            (text, drawing)
        };
        prop_assert_eq!(all(&lines), all(&shuffled));
    }
}

fn run(arguments: &[&str]) -> (bool, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_posecut-report")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.success(), text(output.stdout), text(output.stderr))
}

#[test]
fn the_program_writes_tables_figure_and_document_and_the_page_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let hostile = "</script><img onerror=alert(1)> *{{data}}* | x";
    let mut text = sample("test") + &sample("tuning").replace("\"f ", "\"tuned ") + &filled();
    let _ = write!(text, "{}", done(("test", hostile, "a", 1), "one", 1.0, [1, 0, 0]));
    fs::write(path("r.jsonl"), &text).unwrap();
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/trust.md"), path("trust.md")).unwrap();
    let arguments = [
        "trust",
        &path("r.jsonl"),
        "--figure",
        &path("f.svg"),
        "--document",
        &path("trust.md"),
        "-o",
        &path("t.md"),
    ];
    let (good, _, said) = run(&arguments);
    assert!(good, "{said}");
    let files = ["f.svg", "trust.md", "t.md"].map(|name| fs::read(path(name)).unwrap());
    assert!(run(&arguments).0);
    assert_eq!(
        files,
        ["f.svg", "trust.md", "t.md"].map(|name| fs::read(path(name)).unwrap()),
        "the same bytes again"
    );
    assert!(String::from_utf8_lossy(&files[2]).contains("alert(1)> *{{data}}* \\| x"));

    let (good, page, said) = run(&["html", "--trust", &path("r.jsonl")]);
    assert!(good, "{said}");
    assert!(!page.contains("<img") && page.matches("<script").count() == 2);
    let start = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let data: serde_json::Value =
        serde_json::from_str(&page[start..start + page[start..].find("</script>").unwrap()]).unwrap();
    assert_eq!(data["trust"]["families"][1]["name"], "f");
    assert_eq!(data["trust"]["methods"][0], "one");
    assert_eq!(data["trust"]["families"][1]["methods"][0]["unfinished"], 1);
    assert!(page.contains("<td>4 of 5 (1 failed)</td>"), "tables are there without scripts");
    let (_, page, _) = run(&["html", folder.path().to_str().unwrap()]);
    assert!(page.contains("There are no results of the trust benchmark"));

    let (good, _, said) = run(&["trust", &path("r.jsonl"), "--figure", &path("f.gif"), "-o", &path("n.md")]);
    assert!(!good && said.contains("f.gif") && !Path::new(&path("n.md")).exists(), "{said}");
    let (good, _, said) = run(&["trust", &path("r.jsonl"), "--document", &path("r.jsonl")]);
    assert!(!good && said.contains("has no line <!-- begin: answer -->"), "{said}");
    fs::write(path("half.jsonl"), sample("tuning")).unwrap();
    let (good, _, said) = run(&["trust", &path("half.jsonl")]);
    assert!(!good && said.contains("no run of the test half"), "{said}");
    assert!(run(&["trust", &path("half.jsonl"), "--half", "tuning"]).0);
}

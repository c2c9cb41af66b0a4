//! Examples calculated by hand, and the text of the document.

use posecut_report::figure::plotting::lanes;
use posecut_report::figure::regret::{figure, position, regrets};
use posecut_report::splice::splice;
use posecut_report::trust::Half;
use posecut_report::trust::comparison::{brief, comparison};
use posecut_report::trust::document::sections;
use posecut_report::trust::misses::misses;
use posecut_report::trust::recommendation::{answer, recommended};
use posecut_report::trust::summary::summary;
use posecut_report::trust::tables::{Table, failures, overall, tables};
use std::fs;
use std::path::Path;

use super::{done, failed, filled, read, sample};

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
    assert_eq!(marked, 2, "a ring marks each run with a false edge");
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
        // On the test half `bold` is the best.
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
    // Among the other methods, only one that finished every run can be called the best.
    let some = text.clone() + &done(test("f", 1), "lucky", 0.0, [1, 0, 0]);
    let benchmark = read(&some).unwrap();
    let table = comparison(&benchmark, Half::Test, 0);
    assert_eq!(benchmark.methods[0], "bold");
    let table_of_careful = comparison(&benchmark, Half::Test, 1);
    let row = |table: &Table, row: usize| table.cells[row].join(" ");
    assert_eq!(row(&table_of_careful, 1), "f 2 4.50 0 1.000 bold 0.00 0 1.000 0.00");
    assert_eq!(row(&table_of_careful, 2), "g 1 1.00 1 1.000 bold 1.00 0 1.000 1.00");
    assert_eq!(row(&table_of_careful, 3), "all 3 3.33 1 1.000 bold 0.33 0 1.000 0.33");
    assert_eq!(row(&table, 1), "f 2 0.00 0 1.000 careful 4.50 0 1.000 0.00");
    let said = brief(&benchmark, Half::Test, 1);
    assert!(said.contains("of `careful` and of the best of 2 other methods"), "{said}");
    let row = said.lines().find(|line| line.starts_with("| all")).unwrap();
    assert_eq!(row.split_whitespace().collect::<String>(), "|all|3|3.33|1|bold|0.33|0|", "{said}");
    // A method without a record of some tuning run cannot be recommended, however good it is on the others.
    let gap = text.clone() + &done(tuning("a"), "lucky", 0.0, [1, 0, 0]);
    assert_eq!(benchmark.methods[recommended(&read(&gap).unwrap()).unwrap()], "careful");
    let said = answer(&read(&sample("test")).unwrap()).unwrap_err().to_string();
    assert!(said.contains("no run of the tuning half"), "{said}");
    let said = answer(&read(&sample("tuning")).unwrap()).unwrap_err().to_string();
    assert!(said.contains("no run of the test half"), "{said}");
    // `two` has no record of one run; now `one` has none of another.
    let gaps = sample("tuning").replace(&failed(("tuning", "f", "b", 1), "one"), "");
    let said = answer(&read(&gaps).unwrap()).unwrap_err().to_string();
    assert!(said.contains("no method has a record for every run"), "{said}");
}

#[test]
fn the_documents_of_the_repository_have_every_marker() {
    let text = sample("test") + &sample("tuning").replace("\"f ", "\"tuned ") + &filled();
    let benchmark = read(&text).unwrap();
    for page in ["docs/trust.md", "docs/results/drawn.md"] {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(page);
        let mut document = fs::read_to_string(page).unwrap();
        for (name, section) in sections(&benchmark, Some("diagram.svg")).unwrap() {
            document = splice(&document, name, &section).unwrap();
            assert!(document.contains(section.trim()), "{name}");
        }
        assert!(document.find("**Use `").unwrap() < 200, "the answer comes first");
    }
}

/// `one` is beyond the bound on two runs: it failed one, and on the other it is closer to the truth than the reference is.
#[test]
fn missed_runs_are_listed_beside_the_truth() {
    let with_truth = |own: f64, reference: f64| {
        let line = done(("test", "f", "a", 2), "one", 5.0, [5, 5, 3]);
        let truth =
            format!(r#""ground_truth":{{"poses":9,"rmse":{own},"reference_rmse":{reference}}},"edges":"#);
        sample("test").replace(&line, &line.replace(r#""edges":"#, &truth))
    };
    let text = misses(&read(&with_truth(7.0, 7.5)).unwrap(), Half::Test, 0).markdown();
    assert_eq!(text.lines().filter(|line| line.starts_with("| ")).count(), 3, "{text}");
    for part in ["On 1 of 1 of these runs", "f a, seed 2", "5 of 10", "7.00", "7.50", "two"] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let farther = misses(&read(&with_truth(7.6, 7.5)).unwrap(), Half::Test, 0).markdown();
    assert!(farther.contains("On 0 of 1 of these runs"), "{farther}");
    let said = format!("{:#}", read(&with_truth(-1.0, 7.5)).unwrap_err());
    assert!(said.contains("in field `ground_truth`: field `rmse`: found -1,"), "{said}");
}

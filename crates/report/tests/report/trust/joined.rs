//! The distance of what methods join from the ground truth.

use posecut_report::trust::Half;
use posecut_report::trust::comparison::brief;
use posecut_report::trust::joined::{joined, sentence};

use super::{done, read};

/// A line of results with distances from the ground truth: the optimum of the correct edges, and what the method joins.
fn beside_truth(family: &str, seed: u32, method: &str, distances: [f64; 2]) -> String {
    let [reference, own] = distances;
    let line = done(("test", family, "a", seed), method, 5.0, [9, 1, 0]);
    let truth = format!(
        r#""ground_truth":{{"poses":9,"rmse":7.0,"reference_rmse":{reference},"joined_rmse":{own}}},"edges":"#
    );
    line.replace(r#""edges":"#, &truth)
}

fn rows(text: &str) -> Vec<String> {
    let table = joined(&read(text).unwrap(), Half::Test).unwrap();
    table.cells.iter().map(|row| row.join(" ")).collect()
}

#[test]
fn each_method_has_the_mean_median_and_worst_of_its_runs_with_a_truth() {
    let text = beside_truth("f", 1, "one", [1.0, 2.0])
        + &beside_truth("f", 2, "one", [2.0, 4.0])
        + &beside_truth("f", 3, "one", [3.0, 9.0])
        // Neither a truth nor a distance, as in results of older programs.
        + &done(("test", "f", "a", 4), "one", 5.0, [9, 1, 0]);
    assert_eq!(
        rows(&text),
        [
            "method runs mean, m median worst parts recall",
            "*optimum of the correct edges* 3 2.00 2.00 3.00 – –",
            "one 3 5.00 4.00 9.00 1.00 0.900",
        ]
    );
}

#[test]
fn several_families_have_a_mean_each() {
    let text = beside_truth("f", 1, "one", [1.0, 2.0]) + &beside_truth("g", 1, "one", [3.0, 8.0]);
    assert_eq!(
        rows(&text),
        [
            "method runs f g mean, m median worst parts recall",
            "*optimum of the correct edges* 2 1.00 3.00 2.00 2.00 3.00 – –",
            "one 2 2.00 8.00 5.00 5.00 8.00 1.00 0.900",
        ]
    );
}

/// `three` does not finish every run, so it is not the next method, however close it is.
#[test]
fn a_sentence_compares_the_chosen_method_with_the_next() {
    let text = beside_truth("f", 1, "one", [1.0, 2.0])
        + &beside_truth("f", 2, "one", [2.0, 4.0])
        + &beside_truth("f", 1, "two", [1.0, 5.0])
        + &beside_truth("f", 2, "two", [2.0, 6.0])
        + &beside_truth("f", 1, "three", [1.0, 0.0]);
    let benchmark = read(&text).unwrap();
    let chosen = benchmark.methods.iter().position(|method| method == "one").unwrap();
    let said = sentence(&benchmark, Half::Test, chosen).unwrap();
    let parts = ["`one` joins is 3.00 m", "(2 runs with", "(`two`) joins 5.50 m", "correct edges 1.50 m"];
    assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    let brief = brief(&benchmark, Half::Test, chosen);
    assert!(brief.contains(&format!("|\n\n{said}\n")), "a line of its own\n{brief}");
}

#[test]
fn without_a_ground_truth_there_is_no_table() {
    let text = done(("test", "f", "a", 1), "one", 5.0, [9, 1, 0]);
    let old = beside_truth("f", 1, "one", [1.0, 2.0]).replace(",\"joined_rmse\":2", "");
    assert!(!old.contains("joined") && joined(&read(&old).unwrap(), Half::Test).is_none());
    assert!(joined(&read(&text).unwrap(), Half::Test).is_none());
    let said = read(&beside_truth("f", 1, "one", [1.0, -2.0])).unwrap_err();
    assert!(format!("{said:#}").contains("field `joined_rmse`: found -2"), "{said:#}");
}

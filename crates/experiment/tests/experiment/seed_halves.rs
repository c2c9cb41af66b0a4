//! Tests halves that are blocks of seeds.

use std::collections::BTreeSet;

use crate::workshop::Workshop;
use serde_json::Value;

const HALVES: &str = "\n[halves]\ntuning_seeds = [1, 2]\ntest_seeds = [3, 4]\ndependent = \"the same sessions, other false edges\"\n";

fn experiment() -> String {
    crate::workshop::EXPERIMENT.replacen("seeds = 2\n", "seeds = 4\nfamily = \"mine\"\n", 1) + HALVES
}

/// Seeds and halves of the results of a plan.
fn planned(arguments: &[&str]) -> BTreeSet<(u64, String)> {
    let output = Workshop::new(&experiment()).call("plan", arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let tasks = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let results = tasks.filter(|task| task["stage"] == "evaluate");
    let named = |task: Value| {
        (task["labels"]["seed"].as_u64().unwrap(), task["labels"]["half"].as_str().unwrap().to_owned())
    };
    results.map(named).collect()
}

fn refused(experiment: &str) -> String {
    let output = Workshop::new(experiment).call("plan", &[]);
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn each_half_runs_its_own_seeds() {
    let seeds = |numbers: [u64; 2], half: &str| -> BTreeSet<(u64, String)> {
        numbers.into_iter().map(|number| (number, half.to_owned())).collect()
    };
    let (tuning, test) = (seeds([1, 2], "tuning"), seeds([3, 4], "test"));
    assert_eq!(planned(&["--half", "tuning"]), tuning);
    assert_eq!(planned(&["--half", "test"]), test);
    assert_eq!(planned(&[]), tuning.union(&test).cloned().collect());
}

#[test]
fn blocks_that_mix_tuning_and_test_are_refused() {
    let experiment = experiment();
    let said = refused(&experiment.replace("[3, 4]", "[2, 3, 4]"));
    assert!(said.contains("seed 2 is in both halves"), "{said}");
    let said = refused(&experiment.replace("[3, 4]", "[3]"));
    assert!(said.contains("seed 4 is in neither half"), "{said}");
    let said = refused(&experiment.replace("test_seeds", "test = [\"one\"]\ntest_seeds"));
    assert!(said.contains("has both names and seeds"), "{said}");
    let said = refused(&experiment.replace("dependent", "# dependent"));
    assert!(said.contains("share their sessions"), "{said}");
    let said = refused(&format!("{experiment}\n[[graphs]]\nfiles = \"*.g2o\"\n"));
    assert!(said.contains("given graphs have only one seed"), "{said}");
}

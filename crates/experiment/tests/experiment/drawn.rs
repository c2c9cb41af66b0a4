//! Tests graphs that a program draws.

use serde_json::Value;

use crate::workshop::Workshop;

const EXPERIMENT: &str = r#"
family = "mine"
seeds = 4
methods = ["pcm"]

[[drawn]]
name = "easy"
options = "--ratio {ratio}"

[[drawn]]
name = "hard"

[stages]
simulate-graph = "--all"

[parameters]
ratio = 1

[[grid]]
ratio = [1, 5]

[halves]
tuning_seeds = [1, 2]
test_seeds = [3, 4]

[method]
pcm = ["pcm"]
oracle = ["oracle"]
"#;

/// The tasks of one stage in the plan of an experiment.
fn planned(experiment: &str, stage: &str) -> Vec<Value> {
    let output = Workshop::new(experiment).call("plan", &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let tasks = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    tasks.filter(|task| task["stage"] == stage).collect()
}

#[test]
fn every_seed_draws_a_graph_for_each_point_of_its_options() {
    let drawn = planned(EXPERIMENT, "simulate-graph");
    let called = |task: &Value| {
        let words = task["argv"].as_array().unwrap().iter().map(|word| word.as_str().unwrap());
        words.collect::<Vec<_>>().join(" ")
    };
    let called: Vec<String> = drawn.iter().map(called).collect();
    // Four seeds with two values of the parameter, and four of the other graphs, which do not depend on it.
    assert_eq!(called.len(), 12, "{called:#?}");
    let with = |text: &str| called.iter().filter(|call| call.contains(text)).count();
    assert_eq!((with("--all --ratio 1 "), with("--all --ratio 5 "), with("--all 3 -o")), (4, 4, 1));
}

#[test]
fn a_drawn_graph_is_a_cluster_of_its_own_in_the_half_of_its_seed() {
    let mut found: Vec<(String, String)> = planned(EXPERIMENT, "evaluate")
        .iter()
        .map(|task| {
            let label = |name: &str| task["labels"][name].as_str().unwrap().to_owned();
            (label("cluster"), label("half"))
        })
        .collect();
    found.sort();
    found.dedup();
    let expected = ["easy", "hard"].iter().flat_map(|name| {
        [(1, "tuning"), (2, "tuning"), (3, "test"), (4, "test")]
            .map(|(seed, half)| (format!("{name}-{seed}"), half.to_owned()))
    });
    assert_eq!(found, expected.collect::<Vec<_>>());
}

#[test]
fn a_run_judges_the_drawn_graphs() {
    let workshop = Workshop::new(EXPERIMENT);
    let output = workshop.call("run", &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let collected = workshop.call("plan", &["--sessions", "hard"]);
    assert!(collected.status.success(), "{}", String::from_utf8_lossy(&collected.stderr));
    assert!(
        !String::from_utf8(collected.stdout).unwrap().contains("easy"),
        "--sessions chooses among drawn graphs"
    );
}

#[test]
fn two_drawn_graphs_of_one_name_are_refused() {
    let output = Workshop::new(&EXPERIMENT.replace("\"hard\"", "\"easy\"")).call("plan", &[]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("two graphs are called \"easy\""), "{said}");
}

#[test]
fn an_unknown_name_is_no_session_to_simulate() {
    let output = Workshop::new(EXPERIMENT).call("plan", &["--sessions", "other"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("there is no graph \"other\"; the experiment has easy, hard"), "{said}");
}

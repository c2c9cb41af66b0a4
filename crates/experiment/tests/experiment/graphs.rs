//! Tests what a declaration with given graphs, halves, joined sessions and limits runs and collects.

use crate::workshop::{Workshop, counts};
use serde_json::Value;

const GRAPHS: &str = r#"
family = "mine"
methods = ["none", "pcm"]
cpu_limit = 60

[method]
none = []
pcm = ["pcm"]
oracle = ["oracle"]

[halves]
tuning = ["first_*"]
test = ["second*"]

[[graphs]]
files = "set/*.g2o"
label = "--labels {folder}/{stem}.csv"
from = "the shelf"
"#;

/// A folder of three graphs with labels, and one graph of two robots.
fn workshop(experiment: &str) -> Workshop {
    let workshop = Workshop::new(experiment);
    std::fs::create_dir_all(workshop.path("data/set")).unwrap();
    std::fs::create_dir_all(workshop.path("data/robots")).unwrap();
    for name in ["first_a", "first_b", "second"] {
        workshop.write(&format!("data/set/{name}.g2o"), name);
        workshop.write(&format!("data/set/{name}.csv"), "i,j,inlier\n");
    }
    for name in ["0", "2", "10"] {
        workshop.write(&format!("data/robots/{name}.g2o"), name);
    }
    workshop
}

fn lines(text: &[u8]) -> Vec<Value> {
    text.split(|byte| *byte == b'\n')
        .filter(|line| !line.is_empty())
        .map(|line| serde_json::from_slice(line).unwrap())
        .collect()
}

fn refused(experiment: &str, more: &[&str]) -> String {
    let output = workshop(experiment).call("plan", more);
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

const DATA: &[&str] = &["--data", "data"];

#[test]
fn graphs_are_converted_labelled_and_judged_like_sessions() {
    let workshop = workshop(GRAPHS);
    workshop.run(DATA);
    let expected =
        counts(&[("convert", 3), ("label", 3), ("oracle", 3), ("pcm", 3), ("optimize", 9), ("evaluate", 6)]);
    assert_eq!(workshop.take_log(), expected);
    let plan = lines(&workshop.call("plan", DATA).stdout);
    let label = plan.iter().find(|task| task["stage"] == "label").unwrap();
    assert_eq!(label["argv"][4], "--labels");
    assert_eq!(label["argv"][5], "data/set/first_a.csv");
    let result = plan.iter().find(|task| task["stage"] == "evaluate").unwrap();
    let labels = serde_json::json!({"pipeline": "trial", "family": "mine", "half": "tuning", "cluster": "first_a",
        "session": "first_a", "seed": 1, "method": "none"});
    assert_eq!(result["labels"], labels);
    // The results depend on labels: with other labels all later tasks run again.
    workshop.write("data/set/second.csv", "i,j,inlier\n1,2,0\n");
    workshop.run(DATA);
    assert_eq!(workshop.take_log()["label"], 1);
}

#[test]
fn a_folder_is_one_graph_of_all_its_files_in_the_order_of_their_numbers() {
    let robots = GRAPHS.replace("set/*.g2o", "robots").replace("first_*", "rob*");
    let plan = lines(&workshop(&robots).call("plan", DATA).stdout);
    let convert = plan.iter().find(|task| task["stage"] == "convert").unwrap();
    let files = ["data/robots/0.g2o", "data/robots/2.g2o", "data/robots/10.g2o"];
    assert_eq!(convert["inputs"], serde_json::json!(files));
    assert_eq!(convert["argv"][2], files[0]);
    assert_eq!(convert["argv"][4], files[2]);
    assert_eq!(convert["id"], "results/trial/robots/converted.jsonl");
}

#[test]
fn a_half_is_run_by_itself_and_a_mixed_declaration_is_refused() {
    let names = |half: &str| {
        let output =
            workshop(GRAPHS).call("plan", &[DATA, &["--half", half, "--format", "results"]].concat());
        String::from_utf8(output.stdout).unwrap()
    };
    let (tuning, test) = (names("tuning"), names("test"));
    assert!(tuning.contains("first_a") && tuning.contains("first_b") && !tuning.contains("second"));
    assert!(test.contains("second") && !test.contains("first"));

    let said = refused(&GRAPHS.replace("[\"second*\"]", "[\"second*\", \"first_b\"]"), DATA);
    assert!(said.contains("\"first_b\" is in both halves"), "{said}");
    let said = refused(&GRAPHS.replace("[\"second*\"]", "[]"), DATA);
    assert!(said.contains("\"second\" is in neither half"), "{said}");
    let one_cluster = GRAPHS.replace("from =", "cluster = \"all\"\nfrom =");
    let said = refused(&one_cluster, DATA);
    assert!(said.contains("belong to one cluster, \"all\", but to different halves"), "{said}");
    let explained = one_cluster.replace("[halves]", "[halves]\ndependent = \"for a reason\"");
    assert!(workshop(&explained).call("plan", DATA).status.success());
    let halves = GRAPHS.find("[halves]").unwrap()..GRAPHS.find("[[graphs]]").unwrap();
    let said = refused(&GRAPHS.replace(&GRAPHS[halves], ""), &[DATA, &["--half", "test"]].concat());
    assert!(said.contains("has no [halves]"), "{said}");
}

#[test]
fn missing_graphs_are_named_with_where_they_come_from() {
    assert!(refused(GRAPHS, &[]).contains("name the folder with --data"));
    let said = refused(&GRAPHS.replace("set/*.g2o", "shelf/*.g2o"), DATA);
    assert!(said.contains("data: has no shelf/*.g2o (the shelf)"), "{said}");
    let twice = format!("{GRAPHS}\n[[graphs]]\nfiles = \"set/second.g2o\"\n");
    assert!(refused(&twice, DATA).contains("two graphs are called \"second\""));
}

#[test]
fn joined_sessions_are_constructed_together_from_the_graphs_of_each() {
    let experiment =
        crate::workshop::EXPERIMENT.replace("\"one\", \"two\"]", "\"one\", \"two\", \"one+two\"]");
    let workshop = Workshop::new(&experiment);
    workshop.run(&[]);
    let log = workshop.take_log();
    assert_eq!((log["simulate"], log["ingest"], log["construct"]), (2, 2, 6));
    let both = &workshop.files("results")["results/trial-simulated/one+two/1/graph.jsonl"];
    assert_eq!(both, "construct 1\ningest\nsimulate\ningest\nsimulate\n");
}

#[test]
fn a_failed_run_is_a_result_and_stays_one_until_something_changes() {
    let workshop = workshop(GRAPHS);
    workshop.write("fail-pcm", "");
    let done = workshop.run(DATA);
    assert_eq!((done["failed_runs"].as_u64(), done["without_input"].as_u64()), (Some(3), Some(6)));
    assert_eq!(done["not_run"], 0);
    assert_eq!(workshop.take_log()["pcm"], 6, "an error is tried twice");
    // Failed runs do not run again, and no files of theirs remain.
    workshop.run(DATA);
    assert!(workshop.take_log().is_empty());
    assert!(workshop.files("results").keys().all(|name| !name.contains("pcm.")));

    let only = [DATA, &["--methods", "pcm"]].concat();
    let records = lines(&workshop.call("collect", &only).stdout);
    assert_eq!(records.len(), 3);
    assert_eq!(records[0]["failed"], "pcm: pcm is out of order");
    assert_eq!(records[0]["labels"]["method"], "pcm");
    assert_eq!(records[0]["labels"]["seed"], 1);

    workshop.remove("fail-pcm");
    workshop.run(DATA);
    assert!(workshop.take_log().is_empty(), "the digest is the same");
    workshop.run(&[DATA, &["--set", "trial.pcm=--gate 2"]].concat());
    assert_eq!(workshop.take_log(), counts(&[("pcm", 3), ("optimize", 3), ("evaluate", 3)]));
    workshop.write("fail-pcm", "");
    workshop.run(&[DATA, &["--set", "trial.pcm=--gate 3"]].concat());
    assert!(
        workshop.files("results").keys().all(|name| !name.contains("pcm.")),
        "results of before are gone"
    );
    workshop.remove("fail-pcm");
    workshop.take_log();
    workshop.run(&[DATA, &["--set", "trial.pcm=--gate 3", "--retry"]].concat());
    assert_eq!(workshop.take_log(), counts(&[("pcm", 3), ("optimize", 3), ("evaluate", 3)]));
}

#[test]
fn collected_results_keep_the_calibration_and_the_doubts_where_there_are_some() {
    let workshop = workshop(GRAPHS);
    let script = std::fs::read_to_string(workshop.path("stage.sh")).unwrap();
    let result = r#"if [ $name = evaluate ]; then
  echo '{"format":"posecut-result","version":1,"labels":{},"rmse":1,"doubts":[{"stage":"pcm","doubt":"nothing-kept"}],"calibration":{"edges":[1]},"ate":{}}' > "$output"
  exit 0
fi
{ echo "$name$said""#;
    let judged = script.replace("{ echo \"$name$said\"", result);
    assert_ne!(judged, script);
    workshop.program("stage.sh", &judged);
    workshop.run(DATA);
    let records = lines(&workshop.call("collect", DATA).stdout);
    assert!(!records.is_empty());
    for record in records {
        assert_eq!(record["calibration"]["edges"][0], 1);
        assert_eq!(record["doubts"][0]["doubt"], "nothing-kept");
        assert!(record.get("ate").is_none(), "what tables do not need is left out");
    }
}

#[cfg(unix)]
#[test]
fn a_task_over_its_limit_is_stopped_and_noted_with_its_time() {
    let workshop = workshop(&GRAPHS.replace("cpu_limit = 60", "cpu_limit = 1"));
    let script = std::fs::read_to_string(workshop.path("stage.sh")).unwrap();
    let slow = script.replace("[ -e slow ]", "[ $name = pcm ] && while :; do :; done\n[ -e slow ]");
    assert_ne!(slow, script);
    workshop.program("stage.sh", &slow);
    let more = [DATA, &["--sessions", "second"]].concat();
    let done = workshop.run(&more);
    assert_eq!(done["failed_runs"], 1, "{done}");
    assert_eq!(workshop.take_log()["evaluate"], 1);
    let collect = [&more[..], &["--methods", "pcm", "--times", "times.jsonl"]].concat();
    let records = lines(&workshop.call("collect", &collect).stdout);
    assert_eq!(records[0]["failed"], "pcm: stopped at 1 CPU seconds");
    let times = lines(&std::fs::read(workshop.path("times.jsonl")).unwrap());
    assert!(times[0]["cpu_seconds"].as_f64().unwrap() >= 1.0, "{times:?}");
    assert_eq!(times[0]["labels"], records[0]["labels"]);
}

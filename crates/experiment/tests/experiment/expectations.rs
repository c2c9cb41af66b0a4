//! Tests the comparison with planted changes: it must find and name each change and the stage that made it.

use std::fs;

use crate::workshop::{EXPERIMENT, Workshop};
use serde_json::{Value, json};

const TOLERANCES: &str = r#"
[tolerance.rmse]
absolute = 0.01
reason = "convergence"
[tolerance.other]
absolute = 1e-9
relative = 1e-9
reason = "rounding"
[[cover]]
experiment = "trial-simulated"
seeds = 1
mean_over = 2
[[order]]
experiment = "trial-simulated"
better = "pcm+gc"
worse = "pcm"
share = 0.75
seeds = 2
reason = "the claim"
"#;

/// A workshop with small results, as stages would write them.
fn results() -> Workshop {
    let workshop = Workshop::new(EXPERIMENT);
    for session in ["one", "two"] {
        fs::create_dir_all(workshop.path(&format!("simulated/{session}"))).unwrap();
        workshop.write(&format!("simulated/{session}/wheels.csv"), "1,0.5,0.5\n2,0.5,0.7\n");
        fs::create_dir_all(workshop.path(&format!("results/trial-simulated/{session}"))).unwrap();
        write_graph(&workshop, &format!("{session}/session.jsonl"), 0, &[], 0.0);
        for seed in 1..=2_u32 {
            let run = format!("{session}/{seed}");
            fs::create_dir_all(workshop.path(&format!("results/trial-simulated/{run}"))).unwrap();
            write_graph(&workshop, &format!("{run}/graph.jsonl"), 4, &[], 0.0);
            for (method, rejected, rmse) in
                [("oracle", &[12, 13][..], 0.0), ("pcm", &[12][..], 40.0), ("pcm+gc", &[10, 12, 13][..], 5.0)]
            {
                write_graph(&workshop, &format!("{run}/{method}.jsonl"), 4, rejected, 0.0);
                write_graph(&workshop, &format!("{run}/{method}.optimized.jsonl"), 4, rejected, 0.25);
                write_result(&workshop, &format!("{run}/{method}.result.json"), rmse + f64::from(seed), 3);
            }
        }
    }
    workshop.write("expected.toml", TOLERANCES);
    accept(&workshop);
    workshop
}

fn write_graph(workshop: &Workshop, name: &str, landmarks: u64, rejected: &[u64], moved: f64) {
    let mut lines = vec![json!({"kind":"header","format":"posecut","version":1,"dimension":2})];
    for id in 0..3_u32 {
        let pose = [f64::from(id) + moved, moved, 0.1];
        lines.push(json!({"kind":"node","id":id,"session":"a","frame":id,"pose":pose}));
    }
    let edge = |kind: &str, id: u64, from: u64, to: u64| json!({"kind":kind,"id":id,"from":from,"to":to,"measurement":[1.0,0.1,0.01],"information":[100.0,0.0,0.0,100.0,0.0,2500.0]});
    lines.extend([edge("odometry", 0, 0, 1), edge("odometry", 1, 1, 2)]);
    for id in 10..10 + landmarks {
        let mut line = edge("landmark", id, 0, 2);
        if rejected.contains(&id) {
            line["rejected_by"] = json!("somebody");
        }
        lines.push(line);
    }
    let lines: Vec<String> = lines.iter().map(Value::to_string).collect();
    let text = lines.join("\n") + "\n";
    workshop.write(&format!("results/trial-simulated/{name}"), &text);
}

fn write_result(workshop: &Workshop, name: &str, rmse: f64, true_positive: u64) {
    let edges =
        json!({"true_positive":true_positive,"false_positive":0,"false_negative":1,"true_negative":2});
    let result = json!({"format":"posecut-result","version":1,"labels":{},"rmse":rmse,"components":1,"poses":3,"poses_unmatched":0,"edges":edges});
    workshop.write(&format!("results/trial-simulated/{name}"), &result.to_string());
}

fn accept(workshop: &Workshop) -> String {
    let output = workshop.call("accept", &["--expected", "expected.toml"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the check; returns exit status, report and JUnit file.
fn check(workshop: &Workshop) -> (Option<i32>, String, String) {
    let output = workshop.call("check", &["--expected", "expected.toml", "--junit", "check.xml"]);
    let said = String::from_utf8(output.stdout).unwrap() + &String::from_utf8_lossy(&output.stderr);
    (output.status.code(), said, fs::read_to_string(workshop.path("check.xml")).unwrap_or_default())
}

/// Edits the JSON Lines records of a file.
fn change(workshop: &Workshop, name: &str, edit: impl Fn(&mut Value)) {
    let name = format!("results/trial-simulated/{name}");
    let text = fs::read_to_string(workshop.path(&name)).unwrap();
    let lines = text.lines().map(|line| {
        let mut value = serde_json::from_str(line).unwrap();
        edit(&mut value);
        value.to_string()
    });
    let lines = lines.collect::<Vec<_>>().join("\n") + "\n";
    assert_ne!(lines, text, "the edit changes something");
    workshop.write(&name, &lines);
}

/// The stages that a report names as origins.
fn blamed(said: &str) -> Vec<&str> {
    said.lines().filter_map(|line| line.strip_prefix("FAILED in stage `")?.split('`').next()).collect()
}

#[test]
fn unchanged_results_pass_and_deviations_are_reported() {
    let workshop = results();
    let (status, said, junit) = check(&workshop);
    assert_eq!(status, Some(0), "{said}");
    assert!(
        said.contains(
            "trial-simulated pcm: 2 of 2 files as expected; largest deviation 0.0e0 of its tolerance"
        ),
        "{said}"
    );
    assert!(said.contains("lower RMSE in 4 of 4 runs"), "{said}");
    assert!(
        junit.contains("failures=\"0\"") && junit.contains("classname=\"trial-simulated.pcm\""),
        "{junit}"
    );
    assert_eq!(accept(&workshop), "nothing changed\n");
}

#[test]
fn a_number_off_within_its_tolerance_passes_and_beyond_it_fails() {
    let workshop = results();
    write_result(&workshop, "one/1/pcm.result.json", 41.009, 3);
    let (status, said, _) = check(&workshop);
    assert_eq!(status, Some(0), "{said}");
    assert!(
        said.contains(
            "largest deviation 9.0e-1 of its tolerance (rmse of trial-simulated/one/1/pcm.result.json)"
        ),
        "{said}"
    );
    assert_eq!(accept(&workshop), "nothing changed\n", "noise within the tolerance is not recorded");
    write_result(&workshop, "one/1/pcm.result.json", 41.011, 3);
    let (status, said, junit) = check(&workshop);
    assert_eq!((status, blamed(&said)), (Some(1), vec!["evaluate"]), "{said}");
    assert!(
        said.contains(
            "rmse: expected 41, found 41.011, off by 1.100e-2 where 1.0e-2 is allowed (convergence)"
        ),
        "{said}"
    );
    assert!(
        junit.contains("failures=\"1\"") && junit.contains("<failure message=\"rmse: expected 41"),
        "{junit}"
    );
}

#[test]
fn another_choice_of_edges_is_reported_by_its_ids_and_blamed_on_the_stage() {
    let workshop = results();
    let flip = |value: &mut Value| {
        if value["id"] == 11 && value["kind"] == "landmark" {
            value["rejected_by"] = json!("pcm");
        } else if value["id"] == 12 {
            value.as_object_mut().unwrap().remove("rejected_by");
        }
    };
    // PCM differs, and so do the stages after it.
    for name in ["one/1/pcm.jsonl", "one/1/pcm.optimized.jsonl", "one/1/pcm+gc.jsonl"] {
        change(&workshop, name, flip);
    }
    write_result(&workshop, "one/1/pcm.result.json", 3.0, 2);
    let (status, said, _) = check(&workshop);
    assert_eq!((status, blamed(&said)), (Some(1), vec!["pcm"]), "{said}");
    assert!(said.contains("rejected: now also 11; no longer 12"), "{said}");
    assert!(
        said.contains("made by: ./stage.sh pcm results/trial-simulated/one/1/graph.jsonl -- --gate 1"),
        "{said}"
    );
    assert!(
        said.contains("differ too, perhaps only for that reason: evaluate 2, multicut 1, optimize 1."),
        "{said}"
    );
}

#[test]
fn a_swapped_frame_is_blamed_on_the_stage_that_swaps_it() {
    let workshop = results();
    let swap = |value: &mut Value| {
        if value["kind"] == "landmark" {
            value["measurement"] = json!([-1.0, -0.1, -0.01]);
        }
    };
    for session in ["one", "two"] {
        for name in
            ["graph", "oracle", "pcm", "pcm+gc", "oracle.optimized", "pcm.optimized", "pcm+gc.optimized"]
        {
            change(&workshop, &format!("{session}/1/{name}.jsonl"), swap);
        }
    }
    let (status, said, _) = check(&workshop);
    assert_eq!((status, blamed(&said)), (Some(1), vec!["construct"]), "{said}");
    assert!(said.contains("landmark_x: expected 1, found -1, off by 2.000e0"), "{said}");
}

#[test]
fn faults_of_two_stages_are_both_named() {
    let workshop = results();
    change(&workshop, "two/1/pcm+gc.jsonl", |value| {
        if value["kind"] == "landmark" {
            value.as_object_mut().unwrap().remove("rejected_by");
        }
    });
    change(&workshop, "one/1/oracle.optimized.jsonl", |value| {
        if value["kind"] == "node" {
            value["pose"][0] = json!(9.0);
        }
    });
    let (_, said, _) = check(&workshop);
    assert_eq!(blamed(&said), ["optimize", "multicut"], "{said}");
}

#[test]
fn a_missing_or_broken_file_fails() {
    let workshop = results();
    workshop.remove("results/trial-simulated/one/1/graph.jsonl");
    workshop.write("results/trial-simulated/two/1/pcm.result.json", "{\"rmse\": null}");
    let (status, said, _) = check(&workshop);
    assert_eq!(status, Some(1));
    assert!(said.contains("graph.jsonl: cannot be read"), "{said}");
    assert!(said.contains("pcm.result.json: is not a result"), "{said}");
    let before = fs::read(workshop.path("expected.toml")).unwrap();
    let output = workshop.call("accept", &["--expected", "expected.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(before, fs::read(workshop.path("expected.toml")).unwrap());
}

#[test]
fn an_order_that_no_longer_holds_fails() {
    let workshop = results();
    for session in ["one", "two"] {
        write_result(&workshop, &format!("{session}/2/pcm+gc.result.json"), 60.0, 3);
    }
    let (status, said, _) = check(&workshop);
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("lower RMSE in 2 of 4 runs, a share of 0.50, where at least 0.75 is expected (the claim); not in one/2 (60.000 m against 42.000 m)"), "{said}");
    // Seed 2 has no row of its own, but the mean has one.
    assert!(said.contains("trial-simulated/one/1-2/pcm+gc.result.json"), "{said}");
}

#[test]
fn a_share_is_judged_on_the_sessions_it_was_recorded_for() {
    // This is like a plan with two of the four NCLT sessions: 1 of 2 runs is below the share for all sessions.
    let workshop = results();
    let text = fs::read_to_string(workshop.path("expected.toml")).unwrap();
    write_result(&workshop, "one/2/pcm+gc.result.json", 60.0, 3);
    let judged = |sessions: &str| {
        let text = text.replace("share = 0.75", &format!("share = 0.75\nsessions = {sessions}"));
        workshop.write("expected.toml", &text);
        check(&workshop).1
    };
    assert!(judged("[\"one\"]").contains("lower RMSE in 1 of 2 runs"));
    let said = judged("[\"one\", \"two\"]");
    assert!(!said.contains("where at least 0.75 is expected (the claim)"), "3 of 4 suffice: {said}");
    let said = judged("[\"one\", \"three\"]");
    assert!(!said.contains("1 of 2 runs"), "a session is missing: {said}");
    assert!(said.contains("not judged") && said.contains("this plan lacks three"), "{said}");
}

#[test]
fn accepting_records_and_tells_what_changed() {
    let workshop = results();
    write_result(&workshop, "one/1/pcm.result.json", 50.0, 2);
    let said = accept(&workshop);
    assert!(said.contains("trial-simulated/one/1/pcm.result.json: rmse: 41 -> 50"), "{said}");
    assert!(
        said.contains("trial-simulated/one/1/pcm.result.json: true_positive: expected 3, found 2"),
        "{said}"
    );
    assert!(said.contains("trial-simulated/one/1-2/pcm.result.json: rmse: 41.5 -> 46"), "{said}");
    assert_eq!(said.lines().count(), 3, "{said}");
    assert_eq!(check(&workshop).0, Some(0));
    let text = fs::read_to_string(workshop.path("expected.toml")).unwrap();
    assert!(
        text.contains("reason = \"the claim\"") && text.contains("share = 0.75"),
        "what is written by hand stays"
    );
}

#[test]
fn a_file_without_expectation_fails() {
    let workshop = results();
    let text = fs::read_to_string(workshop.path("expected.toml")).unwrap();
    let rest = text.replace("trial-simulated/two/1/pcm.jsonl", "trial-simulated/three/1/pcm.jsonl");
    workshop.write("expected.toml", &rest);
    let (status, said, _) = check(&workshop);
    assert_eq!(status, Some(1));
    assert!(said.contains("has no expectation yet"), "{said}");
    assert!(said.contains("not checked, because this plan does not write them: 1 file"), "{said}");
}

/// Regression: `accept -o` with the name of a result replaced the result by the list of changes.
#[test]
fn no_output_takes_the_place_of_a_result_or_of_the_expectations() {
    let result = "results/trial-simulated/one/1/pcm.result.json";
    let calls: [(&str, &[&str], &str); 7] = [
        ("accept", &["--expected", "expected.toml", "-o", result], result),
        ("accept", &["--expected", "expected.toml", "-o", "expected.toml"], "expected.toml"),
        ("check", &["--expected", "expected.toml", "-o", result], result),
        ("check", &["--expected", "expected.toml", "--junit", result], result),
        ("check", &["--expected", "expected.toml", "--junit", "expected.toml"], "expected.toml"),
        ("collect", &["-o", result], result),
        ("collect", &["--times", result], result),
    ];
    let workshop = results();
    for (task, more, kept) in calls {
        let before = fs::read(workshop.path(kept)).unwrap();
        let output = workshop.call(task, more);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{task} {more:?}: {said}");
        assert!(said.contains("one would overwrite the other"), "{task} {more:?}: {said}");
        assert_eq!(fs::read(workshop.path(kept)).unwrap(), before, "{task} {more:?}");
    }
}

/// Regression: the expectations were recorded although the changes could not be shown.
#[test]
fn changes_that_cannot_be_shown_are_not_recorded() {
    let workshop = results();
    let before = fs::read(workshop.path("expected.toml")).unwrap();
    write_result(&workshop, "one/1/pcm.result.json", 50.0, 2);
    let output = workshop.call("accept", &["--expected", "expected.toml", "-o", "no/such/folder"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read(workshop.path("expected.toml")).unwrap(), before);
}

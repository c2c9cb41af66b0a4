//! Tests that a plan runs each task once and gives the same bytes: in parallel, after failures and after being killed.

use std::process::{Command, Stdio};

use crate::workshop::{EXPERIMENT, GRID, Workshop, assert_same, counts};

#[test]
fn what_several_runs_share_runs_once() {
    let workshop = Workshop::new(EXPERIMENT);
    let done = workshop.run(&[]);
    // Two sessions, two seeds. oracle, pcm and pcm+gc are optimised; pcm is the first step of pcm+gc.
    let expected = counts(&[
        ("simulate", 2),
        ("ingest", 2),
        ("construct", 4),
        ("oracle", 4),
        ("pcm", 4),
        ("multicut", 4),
        ("optimize", 12),
        ("evaluate", 8),
    ]);
    assert_eq!(workshop.take_log(), expected);
    assert_eq!(done["run"], 40);
    let result = &workshop.files("results")["results/trial-simulated/two/2/pcm+gc.result.json"];
    let chain = "evaluate --label pipeline=trial-simulated --label session=two --label seed=2 --label method=pcm+gc\n\
                 optimize\nmulticut\npcm --gate 1\nconstruct 2\ningest\nsimulate\n\
                 optimize\noracle\nconstruct 2\ningest\nsimulate\n";
    assert_eq!(result, chain);
}

#[test]
fn finished_tasks_do_not_run_again_and_changed_ones_do() {
    let workshop = Workshop::new(EXPERIMENT);
    workshop.run(&[]);
    workshop.take_log();
    let again = workshop.run(&[]);
    assert_eq!((again["run"].as_u64(), again["finished_before"].as_u64()), (Some(0), Some(40)));
    assert!(workshop.take_log().is_empty());

    // After a change of options, that stage and all later ones run again.
    workshop.run(&["--set", "trial.pcm=--gate 2"]);
    let expected = counts(&[("pcm", 4), ("multicut", 4), ("optimize", 8), ("evaluate", 8)]);
    assert_eq!(workshop.take_log(), expected);

    // After a change of the program, all its tasks run again.
    let script = std::fs::read_to_string(workshop.path("stage.sh")).unwrap();
    workshop.program("stage.sh", &format!("{script}# changed\n"));
    assert_eq!(workshop.run(&["--set", "trial.pcm=--gate 2"])["run"], 40);
    workshop.take_log();

    // One output is edited and one is removed.
    workshop.write("results/trial-simulated/one/1/graph.jsonl", "edited");
    workshop.remove("results/trial-simulated/two/2/pcm.result.json");
    workshop.run(&["--set", "trial.pcm=--gate 2"]);
    let log = workshop.take_log();
    assert_eq!(log["construct"], 1);
    assert!(log["evaluate"] >= 1);
    assert!(workshop.files("results").values().all(|text| text != "edited"));
}

#[test]
fn a_failing_task_is_tried_twice_then_listed_and_the_rest_runs() {
    let workshop = Workshop::new(EXPERIMENT);
    workshop.write("fail-multicut", "");
    let output = workshop.call("run", &[]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    for part in [
        "4 tasks failed twice",
        "(8 dependent tasks not run)",
        "multicut is out of order",
        "one/1/pcm+gc.jsonl",
    ] {
        assert!(said.contains(part), "{part} in {said}");
    }
    let log = workshop.take_log();
    assert_eq!((log["multicut"], log["evaluate"], log["optimize"]), (8, 4, 8));
    workshop.remove("fail-multicut");
    workshop.run(&[]);
    assert_eq!(workshop.take_log(), counts(&[("multicut", 4), ("optimize", 4), ("evaluate", 4)]));
}

#[test]
fn a_grid_has_a_folder_for_each_set_of_parameters_and_leaves_only_results() {
    let workshop = Workshop::new(GRID);
    workshop.run(&[]);
    let log = workshop.take_log();
    // Ingest depends only on the scale; construction depends on rate and kind too.
    assert_eq!((log["simulate"], log["ingest"], log["construct"]), (2, 4, 2 * 4 * 2 + 1));
    let left = workshop.files("results");
    assert!(left.keys().all(|name| !name.contains("graph.jsonl") && !name.contains("optimized")), "{left:?}");
    let name = "results/trial-simulated/one/scale=9/kind=uniform,rate=0.5/2/gate=0.99/pcm+gc.result.json";
    let text = &left[name];
    for part in [
        "ingest --sigma 0.3\n",
        "construct --rate 0.5 --kind uniform 2\n",
        "pcm --gate 0.99\n",
        "--label scale=9",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert_eq!(workshop.run(&[])["run"], 0);
    // A removed result is made again with the temporary files that it needs; these are removed afterwards.
    workshop.remove(name);
    workshop.run(&[]);
    assert_same(&workshop.files("results"), &left, "made again");
}

#[test]
fn a_killed_sweep_resumes_to_the_bytes_of_an_undisturbed_one() {
    let undisturbed = Workshop::new(GRID);
    undisturbed.run(&[]);
    for calls in [3, 40, 90] {
        let killed = Workshop::new(GRID);
        killed.write("slow", "");
        let mut child = killed.command("run", &["--threads", "2"]).stderr(Stdio::null()).spawn().unwrap();
        while std::fs::read_to_string(killed.path("log")).unwrap_or_default().lines().count() < calls {
            std::thread::yield_now();
        }
        child.kill().unwrap();
        child.wait().unwrap();
        killed.remove("slow");
        let before: usize = killed.take_log().values().sum();
        let done = killed.run(&[]);
        assert_same(&killed.left(), &undisturbed.left(), &format!("killed after {before} calls"));
        assert!(calls < 40 || done["finished_before"].as_u64() > Some(10), "{done}");
        assert_ne!(done["run"], 0);
    }
}

#[test]
fn shares_of_a_task_list_make_what_one_run_makes() {
    let whole = Workshop::new(GRID);
    whole.run(&[]);
    let shared = Workshop::new(GRID);
    assert!(shared.call("plan", &["-o", "plan.txt"]).status.success());
    std::fs::rename(shared.path("plan.txt"), shared.path("plan.jsonl")).unwrap();
    let early = shared.call("run", &["plan.jsonl", "--shard", "1/3"]);
    assert_eq!(early.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&early.stderr).contains("--shared first"));
    shared.run(&["plan.jsonl", "--shared"]);
    for share in ["3/3", "1/3", "2/3"] {
        assert_ne!(shared.run(&["plan.jsonl", "--shard", share])["run"], 0);
    }
    assert_same(&shared.left(), &whole.left(), "shares");
    assert_eq!(shared.run(&["plan.jsonl"])["run"], 0);
}

#[test]
fn a_task_list_of_another_program_is_refused() {
    let workshop = Workshop::new(GRID);
    let list = workshop.call("plan", &[]).stdout;
    assert_eq!(list, workshop.call("plan", &[]).stdout, "the same plan twice");
    std::fs::write(workshop.path("plan.jsonl"), list).unwrap();
    let script = std::fs::read_to_string(workshop.path("stage.sh")).unwrap();
    workshop.program("stage.sh", &format!("{script}# changed\n"));
    let output = workshop.call("run", &["plan.jsonl"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&output.stderr)
            .contains("has changed since the plan was written; run `plan` again")
    );
}

#[test]
fn make_one_at_a_time_gives_the_same_bytes() {
    for experiment in [EXPERIMENT, GRID] {
        let ours = Workshop::new(experiment);
        ours.run(&[]);
        let make = Workshop::new(experiment);
        assert!(make.call("plan", &["--format", "make", "-o", "plan.mk"]).status.success());
        let output =
            Command::new("make").current_dir(make.path("")).args(["-j1", "-f", "plan.mk"]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let made = make.left();
        let left = ours.left();
        let results: Vec<&String> = left.keys().filter(|name| !name.ends_with(".tasks.jsonl")).collect();
        assert!(results.len() > 10);
        for name in results {
            assert_eq!(made[name], left[name], "{name}");
        }
    }
}

/// Regression: bytes that are not text blocked every later run until somebody deleted the file.
#[test]
fn a_damaged_journal_costs_only_the_tasks_that_it_lost() {
    let workshop = Workshop::new(EXPERIMENT);
    workshop.run(&[]);
    let whole = workshop.left();
    let journal = "results/trial-simulated/one/1.tasks.jsonl";
    let path = workshop.path(journal);
    let text = std::fs::read_to_string(&path).unwrap();
    let mut lines: Vec<Vec<u8>> = text.lines().map(|line| line.as_bytes().to_vec()).collect();
    lines[0] = b"\xff\x00\xfe{".to_vec();
    lines.insert(3, b"not a task".to_vec());
    lines.push(Vec::new());
    let damaged = lines.join(&b'\n');
    std::fs::write(&path, &damaged).unwrap();
    std::fs::write(workshop.path("results/trial-simulated/one/1.times.jsonl"), b"\xff\n{").unwrap();
    workshop.take_log();
    let output = workshop.call("run", &[]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains(
            "one/1.tasks.jsonl, line 1: is not the record of a finished task; ignored 2 such lines"
        ),
        "{said}"
    );
    let ran: usize = workshop.take_log().values().sum();
    assert_eq!(ran, 1, "what can be read is finished");
    let kept = std::fs::read(workshop.path(&format!("{journal}.damaged"))).unwrap();
    assert_eq!(kept, damaged);
    workshop.remove(&format!("{journal}.damaged"));
    workshop.remove("results/trial-simulated/one/1.times.jsonl");
    assert_same(&workshop.left(), &whole, "after the damage");
    // A line that a killed run did not finish does not count as damage.
    let unfinished = text.trim_end().len() - 5;
    std::fs::write(&path, &text[..unfinished]).unwrap();
    let output = workshop.call("run", &[]);
    assert!(output.status.success() && !String::from_utf8_lossy(&output.stderr).contains("warning"));
    assert_same(&workshop.left(), &whole, "after the kill");
}

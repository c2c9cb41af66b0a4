//! Tests declarations that lead outside the folder of results, that refer to each other in a circle, or that exceed memory.

use crate::workshop::{EXPERIMENT, GRID, Workshop};

/// The message that refuses an experiment. Checks that it is one sentence and that the run leaves no files in the workshop.
fn refused(workshop: &Workshop, task: &str, more: &[&str]) -> String {
    let output = workshop.call(task, more);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_eq!(said.lines().count(), 1, "one sentence: {said}");
    assert!(workshop.left().is_empty(), "{said}: {:?}", workshop.left());
    said
}

/// Regression: two declarations that named each other as `base` overflowed the stack.
#[test]
fn bases_in_a_circle_are_refused() {
    let workshop = Workshop::new("base = \"second.toml\"\n");
    workshop.write("second.toml", "base = \"third.toml\"\n");
    workshop.write("third.toml", "base = \"./trial.toml\"\n");
    let said = refused(&workshop, "plan", &[]);
    assert!(said.contains("third.toml: its base \"./trial.toml\" builds on it in turn; remove"), "{said}");
    workshop.write("second.toml", "base = \"../../../../../../../dev/zero\"\n");
    assert!(refused(&workshop, "plan", &[]).contains("larger than 16 MiB"));
    for number in 1..100 {
        workshop.write(&format!("{number}.toml"), &format!("base = \"{}.toml\"\n", number + 1));
    }
    workshop.write("trial.toml", "base = \"1.toml\"\n");
    assert!(refused(&workshop, "plan", &[]).contains("a chain may have at most 16 declarations"));
}

/// Regression: sessions named `../../../x` were simulated outside `--simulated`, and their results written outside `--results`.
#[test]
fn names_that_leave_the_folder_of_results_are_refused() {
    for (from, to, part) in [
        ("\"one\"", "\"../../../x\"", "session \"../../../x\" contains '/'"),
        ("\"one\"", "\"one+..\"", "session \"..\" cannot be used as a name"),
        ("\"one\"", "\"/x\"", "session \"/x\" contains '/'"),
        ("\"one\"", "\"\"", "session \"\" cannot be used as a name"),
        ("\"one\"", "\"a\\nb\"", "session \"a\\nb\" contains '\\n'"),
        ("seeds = 2", "seeds = 2\nname = \"../x\"", "name \"../x\" contains '/'"),
        ("none = []", "none = []\n\"../x\" = []", "method \"../x\" contains '/'"),
        ("none = []", "none = [\"../x\"]", "step \"../x\" contains '/'"),
        (
            "[method]",
            "[parameters]\nx = \"/../../../x\"\n[method]",
            "parameters.x: the value \"/../../../x\"",
        ),
        ("[method]", "[parameters]\n\"../x\" = 1\n[method]", "parameter \"../x\" contains '/'"),
        (
            "[method]",
            "[parameters]\nx = 1\n[[grid]]\nx = [\"../x\"]\n[method]",
            "grid, x: the value \"../x\"",
        ),
    ] {
        let workshop = Workshop::new(&EXPERIMENT.replace(from, to));
        let said = refused(&workshop, "run", &[]);
        assert!(said.contains(part), "\"{part}\" is not in: {said}");
    }
    let workshop = Workshop::new(EXPERIMENT);
    assert!(refused(&workshop, "run", &["--sessions", "one,../x"]).contains("session \"../x\""));
    let long = format!("\"{}\"", "x".repeat(300));
    let workshop = Workshop::new(&EXPERIMENT.replace("\"one\"", &long));
    assert!(refused(&workshop, "run", &[]).contains("is 300 bytes long"));
}

/// Regression: a task list wrote to any path that it named.
#[test]
fn task_lists_that_leave_the_folder_of_results_are_refused() {
    let workshop = Workshop::new(EXPERIMENT);
    let list = String::from_utf8(workshop.call("plan", &[]).stdout).unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let outside = elsewhere.path().to_str().unwrap();
    for folder in [outside, "../posecut-nowhere", "results/missing/../../x", "results/..", "elsewhere"] {
        let moved = list.replace("results/trial-simulated", folder);
        workshop.write("plan.jsonl", &moved);
        let output = workshop.call("run", &["plan.jsonl"]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{folder}: {said}");
        assert!(said.contains("plan.jsonl: ") && said.lines().count() == 1, "{folder}: {said}");
        assert!(said.contains("outside the folders of --results") || said.contains("leads back"), "{said}");
        assert!(workshop.left().is_empty() && !workshop.path("elsewhere").exists(), "{folder}");
        assert_eq!(std::fs::read_dir(outside).unwrap().count(), 0, "{folder}");
    }
    workshop.write("plan.jsonl", &list.replace("results/", "elsewhere/"));
    let output = workshop.call("plan", &["plan.jsonl", "--results", "elsewhere"]);
    // If the command line names the folder, only the digests are wrong.
    assert!(String::from_utf8_lossy(&output.stderr).contains("run `plan` again"));
}

#[cfg(unix)]
#[test]
fn links_that_leave_the_folder_of_results_are_refused() {
    let elsewhere = tempfile::tempdir().unwrap();
    let precious = elsewhere.path().join("precious");
    for link in [
        "results/trial-simulated",
        "results/trial-simulated/one/1",
        "results/trial-simulated/one/1/pcm.jsonl",
        "results/trial-simulated/one/1.tasks.jsonl",
        "simulated/one",
        "simulated/two.times.jsonl",
    ] {
        let workshop = Workshop::new(EXPERIMENT);
        std::fs::write(&precious, "precious").unwrap();
        let target = if link.contains(".jsonl") { precious.as_path() } else { elsewhere.path() };
        std::fs::create_dir_all(workshop.path(link).parent().unwrap()).unwrap();
        std::os::unix::fs::symlink(target, workshop.path(link)).unwrap();
        let output = workshop.call("run", &[]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{link}: {said}");
        assert!(said.contains("outside the folders of --results"), "{link}: {said}");
        assert_eq!(std::fs::read_to_string(&precious).unwrap(), "precious", "{link}");
        assert_eq!(std::fs::read_dir(elsewhere.path()).unwrap().count(), 1, "{link}");
    }
    // The folders themselves may be links.
    let workshop = Workshop::new(EXPERIMENT);
    for folder in ["results", "simulated"] {
        let real = elsewhere.path().join(folder);
        std::fs::create_dir(&real).unwrap();
        std::os::unix::fs::symlink(real, workshop.path(folder)).unwrap();
    }
    assert_eq!(workshop.run(&[])["run"], 40);
}

/// Regression: a plan of 100 million seeds took 4 GB before anything ran.
#[test]
fn more_results_than_a_plan_can_have_are_refused() {
    let workshop = Workshop::new(&EXPERIMENT.replace("seeds = 2", "seeds = 100000000"));
    let said = refused(&workshop, "plan", &[]);
    assert!(said.contains("100000000 seeds") && said.contains("the 100000 results"), "{said}");
    let workshop = Workshop::new(EXPERIMENT);
    assert!(refused(&workshop, "plan", &["--seeds", "18446744073709551615"]).contains("100000"));
    let lines =
        |value: &str| (0..40).map(|axis| format!("a{axis} = {value}")).collect::<Vec<_>>().join("\n") + "\n";
    let many = GRID
        .replace("[parameters]\n", &format!("[parameters]\n{}", lines("1")))
        .replace("rate = [0.1, 0.5]\n", &lines("[1, 2, 3]"));
    assert!(refused(&Workshop::new(&many), "plan", &[]).contains("points of its grid"));
}

//! Tests valid declarations, and the messages for invalid ones.

use crate::workshop::{EXPERIMENT, GRID, Workshop};

fn refused(experiment: &str, more: &[&str]) -> String {
    let output = Workshop::new(experiment).call("plan", more);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn mistakes_are_reported_with_place_and_remedy() {
    let cases: &[(&str, &str, &str)] = &[
        ("sessions", "sesions", "unknown field `sesions`"),
        (
            "\"pcm\", \"pcm+gc\"]",
            "\"pcn\"]",
            "there is no method \"pcn\"; [method] declares none, oracle, pcm, pcm+gc",
        ),
        ("\"multicut\"]", "\"multicat\"]", "there is no stage \"multicat\""),
        ("--gate 1", "--gate {gate}", "\"{gate}\" in the options is not a parameter"),
        (
            "pcm = \"--gate 1\"",
            "pcm = { prog = \"x\" }",
            "a step can have \"program\" and \"options\", but not \"prog\"",
        ),
        ("seeds = 2", "base = \"trial.toml\"", "names itself as its base"),
    ];
    for (from, to, told) in cases {
        assert!(EXPERIMENT.contains(from));
        let said = refused(&EXPERIMENT.replacen(from, to, 1), &[]);
        assert!(said.contains(told) && said.contains("trial"), "{told} in {said}");
    }
    let said = refused(&GRID.replace("[[grid]]\nscale", "[[grid]]\nskale"), &[]);
    assert!(said.contains("a grid varies \"skale\", which is not a parameter"), "{said}");
    let said = refused(
        &GRID
            .replace("factor = 0.1, ", "factor = 0.1, power = -1, ")
            .replace(", power = 0.5", "")
            .replace("[1, 9]", "[0]"),
        &[],
    );
    assert!(said.contains("\"sigma\" is not a finite number for scale = 0"), "{said}");
    let said =
        refused(&GRID.replace("--gate {gate}", "").replace("[parameters]", "[parameters]\nmethod = 1"), &[]);
    assert!(said.contains("\"method\" cannot be a parameter"), "{said}");
}

#[test]
fn the_command_line_is_held_to_the_declaration() {
    assert!(refused(EXPERIMENT, &["--set", "gate=1"]).contains("expected EXPERIMENT.STEP=OPTIONS"));
    assert!(refused(EXPERIMENT, &["--methods", "gcm"]).contains("there is no method \"gcm\""));
    assert!(refused(EXPERIMENT, &["--program", "pcn=x"]).contains("there is no stage \"pcn\""));
    assert!(refused(EXPERIMENT, &["--nclt", "nowhere"]).contains("no session has data"));
    assert!(
        refused(EXPERIMENT, &["--program", "pcm=./none"]).contains("./none: this program does not exist")
    );
}

#[test]
fn a_swapped_stage_is_called_in_its_place() {
    let workshop = Workshop::new(EXPERIMENT);
    workshop.program("mine.sh", &std::fs::read_to_string(workshop.path("stage.sh")).unwrap());
    let plan = String::from_utf8(workshop.call("plan", &["--program", "pcm=./mine.sh"]).stdout).unwrap();
    let runs_mine = |line: &&str| line.contains("\"argv\":[\"./mine.sh\"");
    let mine: Vec<&str> = plan.lines().filter(runs_mine).collect();
    assert_eq!(mine.len(), 4, "{plan}");
    assert!(mine.iter().all(|line| line.contains("\"stage\":\"pcm\"") && !line.contains("--gate")));
    // The results of the methods that use it name it.
    for line in plan.lines().filter(|line| line.contains("\"stage\":\"evaluate\"")) {
        let uses = line.contains("method=pcm");
        assert_eq!(line.contains("\"replaced=pcm = ./mine.sh\""), uses, "{line}");
    }
    // If options are given for the replacement, it gets those.
    let own = ["--program", "pcm=./mine.sh", "--set", "trial.pcm=--reach 3"];
    let plan = String::from_utf8(workshop.call("plan", &own).stdout).unwrap();
    let mine: Vec<&str> = plan.lines().filter(runs_mine).collect();
    assert!(mine.len() == 4 && mine.iter().all(|line| line.contains("\"--reach\",\"3\"")), "{plan}");
}

#[test]
fn a_declaration_builds_on_another() {
    let workshop = Workshop::new("base = \"ground.toml\"\nseeds = 1\n[stages]\npcm = \"--gate 7\"\n");
    workshop.write("ground.toml", EXPERIMENT);
    let plan = String::from_utf8(workshop.call("plan", &[]).stdout).unwrap();
    assert!(plan.contains("\"--gate\",\"7\"") && !plan.contains("seed=2"));
    assert!(plan.contains("pipeline=trial-simulated"));
}

#[test]
fn real_and_simulated_sessions_and_exceptions_are_as_declared() {
    let declared = EXPERIMENT
        .replace("simulated_sessions = [\"one\", \"two\"]", "simulated_sessions = [\"two\", \"three\"]");
    let workshop = Workshop::new(&declared);
    for name in ["one", "two"] {
        std::fs::create_dir_all(workshop.path("nclt").join(name)).unwrap();
    }
    let results = |more: &[&str]| {
        let more = [more, &["--format", "results"]].concat();
        let text = String::from_utf8(workshop.call("plan", &more).stdout).unwrap();
        ["one", "two", "three"].map(|name| text.matches(&format!("/{name}/")).count())
    };
    assert_eq!(results(&[]), [0, 4, 4]);
    assert_eq!(results(&["--nclt", "nclt"]), [4, 4, 0]);
    assert_eq!(results(&["--sessions", "two"]), [0, 4, 0], "the command line has the last word");
    // A declaration that builds on this one inherits the sessions to simulate, unless it names sessions of its own.
    workshop.write("ground.toml", &declared);
    workshop.write("trial.toml", "base = \"ground.toml\"\nseeds = 1\n");
    assert_eq!(results(&[]), [0, 2, 2]);
    workshop.write("trial.toml", "base = \"ground.toml\"\nseeds = 1\nsessions = [\"one\"]\n");
    assert_eq!(results(&["--nclt", "nclt"]), [2, 0, 0]);
    refuses_to_simulate(&workshop, &[], "one");
    // A block of a grid may leave a session out.
    let workshop =
        Workshop::new(&GRID.replace("sessions = [\"one\"]\nseeds = 1", "except = [\"one\"]\nseeds = 1"));
    let text = String::from_utf8(workshop.call("plan", &["--format", "results"]).stdout).unwrap();
    let grouped: Vec<&str> = text.lines().filter(|line| line.contains("kind=grouped")).collect();
    assert!(grouped.len() == 2 && grouped.iter().all(|line| line.contains("/two/")), "{text}");
    assert!(text.contains("/one/"));
}

/// Regression: a sweep over sessions of the user's own, without the folder of their data, simulated sessions of those names.
#[test]
fn sessions_are_simulated_only_under_names_that_the_declaration_allows() {
    let workshop = Workshop::new(EXPERIMENT);
    refuses_to_simulate(&workshop, &["--sessions", "mine"], "mine");
    refuses_to_simulate(&workshop, &["--sessions", "one+mine"], "mine");
    let workshop = Workshop::new(&EXPERIMENT.replace("simulated_sessions = [\"one\", \"two\"]\n", ""));
    refuses_to_simulate(&workshop, &[], "one");
    let workshop = Workshop::new(
        &EXPERIMENT.replace("simulated_sessions = [\"one\", \"two\"]", "source = \"simulated\""),
    );
    assert!(workshop.call("plan", &["--sessions", "mine"]).status.success(), "the declaration asks for it");
}

fn refuses_to_simulate(workshop: &Workshop, more: &[&str], session: &str) {
    let output = workshop.call("plan", more);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains(&format!("session \"{session}\" has no data")), "{said}");
    assert!(said.contains("--nclt DIRECTORY") && said.contains("simulated_sessions"), "{said}");
}

#[test]
fn runs_that_would_overwrite_each_other_are_refused() {
    // Two blocks with the same point and different methods are joined. A parameter that no option names still distinguishes runs.
    let twice = GRID.replace("[[grid]]\nkind = [\"grouped\"]", "[[grid]]\nkind = [\"uniform\"]");
    let workshop = Workshop::new(&twice);
    let plan = String::from_utf8(workshop.call("plan", &["--format", "results"]).stdout).unwrap();
    let mut lines: Vec<&str> = plan.lines().collect();
    let all = lines.len();
    lines.sort_unstable();
    lines.dedup();
    assert_eq!(all, lines.len());
}

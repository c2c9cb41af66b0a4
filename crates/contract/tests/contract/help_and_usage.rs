//! Tests that errors of the command line have the form of all other errors.

use posecut_contract::run;

use posecut_contract::registry::table;

fn refused(name: &str, arguments: &[&str]) -> String {
    let output = run(name, arguments, b"");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{name} {arguments:?}: {said}");
    assert!(output.stdout.is_empty(), "{name} {arguments:?}");
    assert_eq!(said.lines().count(), 1, "{name} {arguments:?}: one sentence: {said}");
    assert!(said.starts_with(&format!("posecut-{name}: error: ")), "{said}");
    assert!(said.contains(&format!("posecut-{name} --help")), "the remedy: {said}");
    said
}

/// Regression: these errors were clap's paragraphs, without the program's name.
#[test]
fn usage_errors_are_one_sentence_with_a_suggestion() {
    for row in table() {
        let task: &[&str] = match row.name {
            "experiment" | "inspect" | "partition" | "report" => &row.arguments[..1],
            _ => &[],
        };
        let said = |more: &[&str]| refused(row.name, &[task, more].concat());
        let unknown = said(&["--threds", "1"]);
        assert!(
            unknown.contains("'--threds'") && unknown.contains("similar argument exists: '--threads'"),
            "{unknown}"
        );
        let value = said(&["--threads", "many\nlines"]);
        assert!(value.contains("'--threads <N>'") && value.contains("invalid digit"), "{value}");
        assert!(said(&["--stats"]).contains("a value is required"));
        assert!(said(&["--quiet", "--verbose"]).contains("cannot be used with"));
    }
    assert!(refused("pcm", &["--scheme", "none"]).contains("[possible values: "));
    assert!(refused("experiment", &[]).contains("use one of plan, run, collect, check, accept, stages"));
    assert!(refused("experiment", &["pln"]).contains("similar subcommand exists: 'plan'"));
}

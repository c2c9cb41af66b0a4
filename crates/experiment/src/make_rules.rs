//! A plan as rules for Make, for people who want Make to run it, and as the yardstick for other engines.

use std::fmt::Write as _;

use crate::Plan;

/// Rules for GNU Make: `make -f FILE` runs the plan, with `-j` in parallel. Make goes by times, not by digests:
/// it does not see that an option has changed.
pub fn make_rules(plan: &Plan) -> String {
    let mut text = String::from(
        "equals := =\n# Written by posecut-experiment plan --format make.\n.DELETE_ON_ERROR:\n.SECONDARY:\n",
    );
    let finals = plan.tasks.iter().filter(|task| !task.temporary).flat_map(|task| &task.outputs);
    // Writing to a string cannot fail.
    let _ =
        writeln!(text, ".PHONY: all\nall: {}", finals.map(|path| name(path)).collect::<Vec<_>>().join(" "));
    for task in &plan.tasks {
        let words = |paths: &[String]| paths.iter().map(|path| name(path)).collect::<Vec<_>>().join(" ");
        let _ = writeln!(text, "\n{}: {}", words(&task.outputs), words(&task.inputs));
        let _ = writeln!(text, "\t@mkdir -p $(@D)");
        let command: Vec<String> = task.argv.iter().map(|word| shell(word)).collect();
        let _ = writeln!(text, "\t@{}", command.join(" ").replace('$', "$$"));
    }
    text
}

/// A file's name where Make reads names.
fn name(path: &str) -> String {
    path.replace('$', "$$")
        .replace('#', "\\#")
        .replace(' ', "\\ ")
        .replace(':', "\\:")
        .replace('=', "$(equals)")
}

/// A word of a command line, quoted where a shell would take it apart.
pub(crate) fn shell(word: &str) -> String {
    let plain = |character: char| character.is_ascii_alphanumeric() || "-_./=,+:%@".contains(character);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

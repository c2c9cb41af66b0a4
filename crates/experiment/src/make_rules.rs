//! Writes a plan as rules for Make: for users who prefer Make, and as a reference for other engines.

use std::fmt::Write as _;

use crate::Plan;

/// Rules for GNU Make: `make -f FILE` runs the plan, with `-j` in parallel. Make compares times, not digests, so it does not
/// notice a changed option.
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

/// A file's name, escaped for Make.
fn name(path: &str) -> String {
    path.replace('$', "$$")
        .replace('#', "\\#")
        .replace(' ', "\\ ")
        .replace(':', "\\:")
        .replace('=', "$(equals)")
}

/// A word of a command line, quoted if a shell would split it.
pub(crate) fn shell(word: &str) -> String {
    let plain = |character: char| character.is_ascii_alphanumeric() || "-_./=,+:%@".contains(character);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

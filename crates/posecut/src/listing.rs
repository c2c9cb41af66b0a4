//! The output of `posecut help` and `posecut version`.

use std::fmt::Write as _;

use posecut_stage::registry::Registry;
use posecut_stage::{Description, Examples, Phase};

/// The text above the list of programs.
const ABOUT: &str = "posecut finds incorrect landmark edges (false loop closures) in pose graphs.

Usage: posecut NAME [ARGUMENTS]     run posecut-NAME
       posecut help [NAME]          list the programs, or show the help of one
       posecut version              show the versions of all programs

A program reads a pose graph from a file or standard input and writes it to a file or standard output.

";

/// The examples in the help and in the manual page.
pub(crate) const EXAMPLES: Examples = Examples(&[
    (
        "Write a graph without its wrong edges, and a page that shows why",
        "posecut clean graph.g2o -o cleaned.g2o --page graph.html",
    ),
    (
        "Do the same in steps, each by a program of its own",
        "posecut convert graph.g2o | posecut verify | posecut optimize -o map.jsonl",
    ),
    ("Show the options of a program, and its examples", "posecut help verify"),
]);

/// The list of programs. Those beside this one are in the order of a pipeline.
pub fn help(registry: &Registry) -> String {
    let (mut described, mut others) = (Vec::new(), Vec::new());
    for program in registry.beside() {
        match program.description() {
            Some(description) => described.push(description),
            None => others.push(program),
        }
    }
    described.sort_by(|one, other| key(one).cmp(&key(other)));
    others.extend(registry.elsewhere());
    let names = described.iter().map(|one| &one.name).chain(others.iter().map(|one| &one.name));
    let width = names.map(String::len).max().unwrap_or(0);
    let mut text = ABOUT.to_owned() + &EXAMPLES.help();
    for phase in Phase::ALL {
        let mut programs = described.iter().filter(|one| one.phase == phase).peekable();
        if programs.peek().is_some() {
            let _ = writeln!(text, "\n{}:", phase.heading());
        }
        for Description { name, about, .. } in programs {
            let _ = writeln!(text, "  {name:width$}  {about}");
        }
    }
    if !others.is_empty() {
        text.push_str("\nOther programs:\n");
    }
    for program in others {
        let _ = writeln!(text, "  {:width$}  {}", program.name, program.path.display());
    }
    text
}

fn key(description: &Description) -> (Phase, u8, &str) {
    (description.phase, description.order, &description.name)
}

/// The version of each program, one a line.
pub fn versions(registry: &Registry) -> String {
    let mut text = format!("posecut {}\n", env!("CARGO_PKG_VERSION"));
    for program in registry.beside() {
        let version =
            program.version().unwrap_or_else(|| format!("posecut-{}: version unknown", program.name));
        let _ = writeln!(text, "{version}");
    }
    for program in registry.elsewhere() {
        let _ = writeln!(text, "posecut-{}: {}", program.name, program.path.display());
    }
    text
}

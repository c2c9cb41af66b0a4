//! The programs of the workspace, and how the contract calls each of them. Both come from the Cargo.toml of each program.
//!
//! A crate named `posecut-NAME` with a `src/main.rs` is a program. By default it reads a pose graph, writes one and needs no
//! arguments. Other programs declare under `[package.metadata.posecut]` how to call them. So a new program needs no change in
//! another crate.

use std::process::Output;
use std::sync::OnceLock;

use serde::Deserialize;

use crate::{program, run, samples, workspace};

/// A way to call a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// The program's name without `posecut-`.
    pub name: &'static str,
    /// Arguments before the input; `{sample}` stands for a sample's path, `{posecut-NAME}` for a program's.
    pub arguments: &'static [&'static str],
    /// The sample that the program reads, if it reads one file.
    pub input: Option<&'static str>,
    /// Whether the program accepts that input on standard input too.
    pub pipe: bool,
    /// Whether the program writes one file or standard output, and not a folder.
    pub stream: bool,
    /// The keys of its `--stats` on which other programs rely.
    pub statistics: &'static [&'static str],
}

/// One call, as declared in a Cargo.toml.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Call {
    #[serde(default)]
    arguments: Vec<String>,
    input: Option<String>,
    #[serde(default)]
    pipe: bool,
    #[serde(default = "yes")]
    stream: bool,
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
struct Manifest {
    package: Package,
}

#[derive(Deserialize)]
struct Package {
    #[serde(default)]
    metadata: Metadata,
}

#[derive(Default, Deserialize)]
struct Metadata {
    #[serde(default)]
    posecut: Declared,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Declared {
    calls: Option<Vec<Call>>,
    /// Of the first call.
    #[serde(default)]
    statistics: Vec<String>,
}

/// The environment variable that limits the tests of the contract to these programs, separated by spaces.
const ONLY: &str = "POSECUT_CONTRACT_ONLY";

/// Every call of every program, in the order of names.
///
/// # Panics
/// If a crate's Cargo.toml cannot be read or declares something else.
pub fn table() -> &'static [Row] {
    static TABLE: OnceLock<Vec<Row>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let names = xtask::workspace::programs().expect("the workspace has programs");
        let only = std::env::var(ONLY).ok();
        let asked =
            |row: &Row| only.as_ref().is_none_or(|only| only.split_whitespace().any(|name| name == row.name));
        names.into_iter().flat_map(rows).filter(asked).collect()
    })
}

/// The names of all programs, in order.
pub fn programs() -> Vec<String> {
    let mut names: Vec<String> = table().iter().map(|row| row.name.to_owned()).collect();
    names.dedup();
    names
}

impl Row {
    /// The arguments of this call, with the input last.
    ///
    /// # Panics
    /// If a path is not UTF-8.
    pub fn arguments(&self) -> Vec<String> {
        let sample =
            |argument: &&str| match argument.strip_prefix('{').and_then(|rest| rest.strip_suffix('}')) {
                Some(name) => match name.strip_prefix("posecut-") {
                    Some(name) => program(name).to_str().expect("paths are UTF-8").to_owned(),
                    None => samples().path(name),
                },
                None => (*argument).to_owned(),
            };
        let input = self.input.map(|name| samples().path(name));
        self.arguments.iter().map(sample).chain(input).collect()
    }

    /// Runs this call with more arguments, placed before `--` and a command of its own, if there is one.
    pub fn run(&self, more: &[&str]) -> Output {
        let all = self.arguments_with(more);
        let all: Vec<&str> = all.iter().map(String::as_str).collect();
        run(self.name, &all, b"")
    }

    /// The arguments of this call and more, placed before `--` and a command of its own, if there is one.
    pub fn arguments_with(&self, more: &[&str]) -> Vec<String> {
        let mut all = self.arguments();
        let end = all.iter().position(|argument| argument == "--").unwrap_or(all.len());
        all.splice(end..end, more.iter().map(|&word| word.to_owned()));
        all
    }
}

fn rows(name: String) -> Vec<Row> {
    let path = workspace().join("crates").join(&name).join("Cargo.toml");
    let text = std::fs::read_to_string(&path).expect("a crate has a Cargo.toml");
    let Manifest { package } =
        toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let name: &'static str = name.leak();
    let Declared { calls, statistics } = package.metadata.posecut;
    let graph =
        || Call { arguments: Vec::new(), input: Some("graph.jsonl".into()), pipe: true, stream: true };
    let calls = calls.unwrap_or_else(|| vec![graph()]);
    assert!(
        !calls.is_empty(),
        "{}: `calls` is empty, so no test checks the program against the contract; declare at least one call",
        path.display()
    );
    let row = |call: Call| {
        let (arguments, input) = (words(call.arguments), call.input.map(|word| &*word.leak()));
        Row { name, arguments, input, pipe: call.pipe, stream: call.stream, statistics: &[] }
    };
    let mut rows: Vec<Row> = calls.into_iter().map(row).collect();
    rows[0].statistics = words(statistics);
    rows
}

/// Makes words static. They are never freed, because the table lives as long as the test.
fn words(words: Vec<String>) -> &'static [&'static str] {
    words.into_iter().map(|word| &*word.leak()).collect::<Vec<_>>().leak()
}

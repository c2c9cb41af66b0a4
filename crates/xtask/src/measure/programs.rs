//! Builds what is measured: an older program would be measured for the present one.

use std::path::PathBuf;
use std::process::Command;

use anyhow::Context as _;
use serde_json::Value;
use xtask::workspace::root;

use crate::process::{must, visibly};

/// Builds release programs; the words choose which, as for `cargo build`.
pub(super) fn build(words: &[&str]) -> anyhow::Result<()> {
    let mut cargo = Command::new("cargo");
    visibly(cargo.args(["build", "--release", "--locked", "-q"]).args(words).current_dir(root()))
}

/// Builds a bench program of a package.
pub(super) fn bench_program(package: &str, bench: &str) -> anyhow::Result<PathBuf> {
    let mut cargo = Command::new("cargo");
    cargo.args(["bench", "-p", package, "--bench", bench, "--no-run", "--message-format=json"]);
    let output = String::from_utf8(must(cargo.current_dir(root()))?)?;
    let messages = output.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let program = messages.filter(|message| message["target"]["name"] == bench);
    let mut paths = program.filter_map(|message| message["executable"].as_str().map(PathBuf::from));
    paths.next_back().with_context(|| format!("`cargo bench` names no program for the bench {bench}"))
}

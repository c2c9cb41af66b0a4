//! The demands on a program, one function for each.

mod decisions;
mod keeping;
mod manners;
mod refusals;
mod streams;

use std::path::Path;

use anyhow::Context as _;
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_stage::{warn, write_atomically};
use tempfile::TempDir;

use crate::program::{Program, Run};
use crate::report::{CheckReport, Level, Outcome, Report};
use crate::sample;

/// `Err` says why the demand is not met.
type Verdict = Result<(), String>;

/// A demand and the function that checks it.
struct Check {
    name: &'static str,
    level: Level,
    demand: &'static str,
    /// Whether the check makes sense only for a program that turns the sample into a graph.
    works_on_output: bool,
    test: fn(&Bench<'_>) -> anyhow::Result<Verdict>,
}

/// The program, the sample, and the program's output for it.
struct Bench<'a> {
    program: &'a Program,
    folder: TempDir,
    graph: PoseGraph,
    input: Vec<u8>,
    base: Run,
    output: Result<PoseGraph, String>,
}

impl<'a> Bench<'a> {
    fn new(program: &'a Program) -> anyhow::Result<Self> {
        let graph = sample::plane();
        let input = sample::bytes(&graph)?;
        let base = program.run(&[], &input)?;
        let output = graph_of(&base);
        Ok(Self { program, folder: temporary_folder()?, graph, input, base, output })
    }

    /// The path of a file in the bench's own folder.
    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    /// The sample as a file.
    fn input_file(&self) -> anyhow::Result<String> {
        let path = self.path("input.jsonl");
        write_atomically(Path::new(&path), |writer| Ok(writer.write_all(&self.input)?))?;
        Ok(path)
    }

    /// The program's output for the sample.
    fn output(&self) -> Result<&PoseGraph, String> {
        self.output.as_ref().map_err(Clone::clone)
    }

    /// Removes folders of this machine from a text, so that the same program gives the same report everywhere.
    fn scrub(&self, text: &str) -> String {
        text.replace(&self.folder.path().display().to_string(), "FOLDER")
    }
}

/// A folder for the files of a check.
fn temporary_folder() -> anyhow::Result<TempDir> {
    let parent = std::env::temp_dir();
    tempfile::tempdir_in(&parent).with_context(|| {
        // Escape the path, because the environment variable may hold line breaks.
        let place = parent.to_string_lossy().escape_debug().to_string();
        format!("{place}: cannot hold a temporary folder; set TMPDIR to another folder")
    })
}

/// Removes the folder. A failure is only a warning, because the report does not depend on it.
fn remove(folder: TempDir) {
    let path = folder.path().display().to_string();
    if let Err(error) = folder.close() {
        warn!("{path}: the temporary folder cannot be removed ({error}); remove it");
    }
}

/// The graph that a run wrote, or the reason why there is none.
fn graph_of(run: &Run) -> Result<PoseGraph, String> {
    if !run.succeeded() {
        return Err(format!("on a valid graph: {}", run.said()));
    }
    PoseGraph::read("its output", run.stdout.as_slice()).map_err(|error| error.to_string())
}

fn must(condition: bool, otherwise: impl FnOnce() -> String) -> Verdict {
    if condition { Ok(()) } else { Err(otherwise()) }
}

/// Runs all checks in a fixed order. This takes some forty runs of the program on graphs of a few hundred nodes.
///
/// An error means that the program cannot be started at all, or that there is no place for temporary files.
pub fn check(program: &Program) -> anyhow::Result<Report> {
    let bench = Bench::new(program)?;
    let all = [streams::CHECKS, keeping::CHECKS, decisions::CHECKS, refusals::CHECKS, manners::CHECKS];
    let mut checks = Vec::new();
    for check in all.into_iter().flatten() {
        let outcome = if check.works_on_output && bench.output.is_err() {
            Outcome::Skipped("the program writes no valid graph for the sample".to_owned())
        } else {
            match (check.test)(&bench)? {
                Ok(()) => Outcome::Passed,
                Err(reason) => Outcome::Failed(bench.scrub(&reason)),
            }
        };
        checks.push(CheckReport { name: check.name, level: check.level, demand: check.demand, outcome });
    }
    let rejected = bench.output.as_ref().ok().map(|output| {
        let marked =
            |graph: &PoseGraph| graph.edges_of(EdgeKind::Landmark).filter(|edge| !edge.in_use()).count();
        (
            marked(output).saturating_sub(marked(&bench.graph)),
            bench.graph.edges_of(EdgeKind::Landmark).count(),
        )
    });
    remove(bench.folder);
    Ok(Report { program: program.arguments.clone(), rejected, checks })
}

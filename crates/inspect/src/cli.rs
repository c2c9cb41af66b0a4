//! The command line of `posecut-inspect`: summarises, validates, compares and filters pose graphs.

use std::process::ExitCode;

use crate::difference::Difference;
use crate::edges::EdgeTable;
use crate::filter::{self, filter};
use crate::info::Info;
use crate::validate::{Severity, validate};
use anyhow::bail;
use clap::{Parser, Subcommand};
use posecut_stage::{
    CommonArguments, Context, Examples, Identity, Outcome, Phase, Place, Source, counted, info, open, run,
};

#[derive(Parser)]
struct Command {
    /// Without a command: the pose graph to summarise (JSON Lines, may be compressed); `-` is standard input
    #[arg(value_name = "INPUT")]
    input: Option<Source>,

    #[command(subcommand)]
    task: Option<Task>,

    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Subcommand)]
#[allow(clippy::large_enum_variant, reason = "there is one, once a run")]
enum Task {
    /// Summarise a graph: sessions, counts, bounding box, rejections, components, history
    Info {
        /// The pose graph to read (JSON Lines, may be compressed); `-` is standard input
        #[arg(value_name = "INPUT", default_value = "-")]
        input: Source,
    },
    /// List all errors and warnings of a graph; exit status 1 if there is an error
    Validate {
        /// The pose graph to read (JSON Lines, may be compressed); `-` is standard input
        #[arg(value_name = "INPUT", default_value = "-")]
        input: Source,

        /// Exit with status 1 for warnings too
        #[arg(long)]
        strict: bool,

        /// List at most this many findings, and count the others
        #[arg(long, value_name = "N", default_value_t = 100)]
        most: usize,
    },
    /// List the landmark edges of a graph: verdict, probability, reason, witnesses, residual
    Edges {
        /// The pose graph to read (JSON Lines, may be compressed); `-` is standard input
        #[arg(value_name = "INPUT", default_value = "-")]
        input: Source,

        /// Write all columns as CSV
        #[arg(long)]
        csv: bool,
    },
    /// List what changed between two graphs; exit status 1 if anything except the history changed
    Diff {
        /// The graph before; `-` is standard input
        #[arg(value_name = "BEFORE")]
        before: Source,

        /// The graph after; `-` is standard input
        #[arg(value_name = "AFTER")]
        after: Source,

        /// Treat numbers that differ by at most this as equal
        #[arg(long, value_name = "SIZE", default_value_t = 0.0)]
        tolerance: f64,
    },
    /// Extract a part of a graph as a valid graph of its own
    Filter {
        /// The pose graph to read (JSON Lines, may be compressed); `-` is standard input
        #[arg(value_name = "INPUT", default_value = "-")]
        input: Source,

        #[command(flatten)]
        options: filter::Options,

        /// Leave rejected edges out of the output instead of marking them
        #[arg(long, help_heading = "Output")]
        drop_rejected: bool,
    },
}

const EXAMPLES: Examples = Examples(&[
    ("Summarise a graph", "posecut inspect graph.jsonl"),
    (
        "Write a table of the verdicts on all landmark edges",
        "posecut verify graph.jsonl | posecut inspect edges --csv -o edges.csv",
    ),
    (
        "Extract one session without its ground truth",
        "posecut inspect filter graph.jsonl --session 2012-01-22 --strip-truth \\\n    -o session.jsonl",
    ),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "inspect",
        version: env!("CARGO_PKG_VERSION"),
        about: "Summarise, validate, compare and extract pose graphs",
        place: Place(Phase::Results, 30),
        examples: EXAMPLES,
    };
    run::<Command>(
        identity,
        |command| &command.common,
        |command, context| match &command.task {
            None => show(command.input.as_ref().unwrap_or(&Source::Standard), context),
            Some(_) if let Some(input) = &command.input => bail!(
                "{input}: comes before the command; write the command first, such as posecut-inspect validate {input}"
            ),
            Some(task) => run_task(task, context),
        },
    )
}

fn run_task(task: &Task, context: &mut Context) -> anyhow::Result<Outcome> {
    match task {
        Task::Info { input } => show(input, context),
        Task::Validate { input, strict, most } => check(input, *strict, *most, context),
        Task::Edges { input, csv } => list(input, *csv, context),
        Task::Diff { before, after, tolerance } => compare(before, after, *tolerance, context),
        Task::Filter { input, options, drop_rejected } => {
            let mut graph = context.read_graph(input, "graph")?;
            let left = filter(&mut graph, options);
            if *drop_rejected {
                graph.drop_rejected();
            }
            info!(
                "kept {} and {}; removed {}, {} by the options for edges, and {} that lost a node",
                counted(graph.nodes.len(), "node"),
                counted(graph.edges.len(), "edge"),
                counted(left.nodes, "node"),
                counted(left.edges, "edge"),
                counted(left.edges_without_nodes, "edge")
            );
            context.statistics.note("nodes", graph.nodes.len());
            context.statistics.note("edges", graph.edges.len());
            context.statistics.note("left_out", left);
            context.record_provenance(&mut graph, options, None)?;
            context.write_graph(&graph)?;
            Ok(Outcome::Done)
        }
    }
}

fn show(input: &Source, context: &mut Context) -> anyhow::Result<Outcome> {
    let info = Info::of(&context.read_graph(input, "graph")?);
    note_all(&info, context)?;
    context.write_bytes(info.to_string().as_bytes())?;
    Ok(Outcome::Done)
}

fn check(input: &Source, strict: bool, most: usize, context: &mut Context) -> anyhow::Result<Outcome> {
    let mut opened = open(input)?;
    let name = opened.name.clone();
    let findings = validate(&name, &mut opened)?;
    let faults = findings.iter().filter(|finding| finding.severity == Severity::Fault).count();
    let warnings = findings.len() - faults;
    let mut text = String::new();
    for finding in findings.iter().take(most) {
        text += &format!("{finding}\n");
    }
    if findings.len() > most {
        let further = counted(findings.len() - most, "further finding");
        text += &format!("and {further}; raise --most to list more\n");
    }
    text += &format!("{name}: {}, {}\n", counted(faults, "error"), counted(warnings, "warning"));
    context.statistics.note("faults", faults);
    context.statistics.note("warnings", warnings);
    context.statistics.note("findings", &findings);
    context.write_bytes(text.as_bytes())?;
    Ok(if faults > 0 || (strict && warnings > 0) { Outcome::CheckFailed } else { Outcome::Done })
}

fn list(input: &Source, csv: bool, context: &mut Context) -> anyhow::Result<Outcome> {
    let table = EdgeTable::of(&context.read_graph(input, "graph")?)?;
    context.statistics.note("edges", &table.rows);
    if csv {
        let mut bytes = Vec::new();
        table.write_csv(&mut bytes)?;
        context.write_bytes(&bytes)?;
    } else {
        context.write_bytes(table.to_string().as_bytes())?;
    }
    Ok(Outcome::Done)
}

fn compare(
    before: &Source,
    after: &Source,
    tolerance: f64,
    context: &mut Context,
) -> anyhow::Result<Outcome> {
    if *before == Source::Standard && *after == Source::Standard {
        bail!("only one of the two graphs can be standard input; name a file for the other");
    }
    if !(tolerance >= 0.0) {
        bail!("--tolerance is {tolerance}, but must be zero or a positive number");
    }
    let before = context.read_graph(before, "before")?;
    let after = context.read_graph(after, "after")?;
    let difference = Difference::between(&before, &after, tolerance)?;
    note_all(&difference, context)?;
    context.write_bytes(difference.to_string().as_bytes())?;
    Ok(if difference.same { Outcome::Done } else { Outcome::CheckFailed })
}

/// Adds every field of a summary to the statistics.
fn note_all(summary: &impl serde::Serialize, context: &mut Context) -> anyhow::Result<()> {
    if let serde_json::Value::Object(fields) = serde_json::to_value(summary)? {
        for (name, value) in fields {
            context.statistics.note(&name, value);
        }
    }
    Ok(())
}

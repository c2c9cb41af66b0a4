//! The command line of `posecut-view`: one HTML page of a pose graph.

use std::process::ExitCode;

use crate::{Frame, View, page, summary};
use anyhow::{Context as _, bail};
use clap::Parser;
use posecut_stage::{
    CommonArguments, Context, Examples, Identity, Outcome, Phase, Place, Source, counted, info, run, warn,
};
use serde_json::{Map, Value};

#[derive(Parser)]
struct Command {
    /// The pose graph to show, after a stage that rejects edges and after posecut-optimize (JSON Lines, may be compressed); `-` is standard input
    #[arg(value_name = "GRAPH", default_value = "-")]
    graph: Source,

    /// Show these poses as the map before [default: dead reckoning from the odometry]
    #[arg(long, value_name = "GRAPH")]
    before: Option<Source>,

    /// Show calibration, rival hypotheses and broken odometry from this file, the `--stats` of posecut-verify
    #[arg(long, value_name = "FILE")]
    verify_stats: Option<Source>,

    /// Choose how coordinates are drawn
    #[arg(long, value_enum, default_value_t)]
    frame: Frame,

    /// Set the title of the page
    #[arg(long, value_name = "TEXT", default_value = "posecut view")]
    title: String,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    (
        "Show what verification rejects, and why",
        "posecut verify graph.jsonl --stats verify.json -o verified.jsonl\nposecut optimize verified.jsonl |\n    posecut view --verify-stats verify.json -o graph.html",
    ),
    (
        "Show the poses before and after optimisation",
        "posecut view map.jsonl --before graph.jsonl -o graph.html",
    ),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "view",
        version: env!("CARGO_PKG_VERSION"),
        about: "Show a graph as one HTML page: which landmark edges are in use, rejected or undecided, and why",
        place: Place(Phase::Results, 25),
        examples: EXAMPLES,
    };
    run::<Command>(identity, |command| &command.common, show)
}

fn show(command: &Command, context: &mut Context) -> anyhow::Result<Outcome> {
    let inputs = [Some(&command.graph), command.before.as_ref(), command.verify_stats.as_ref()];
    if inputs.into_iter().flatten().filter(|source| **source == Source::Standard).count() > 1 {
        bail!("only one input can be standard input; name files for the others");
    }
    let graph = context.read_graph(&command.graph, "graph")?;
    let before = command.before.as_ref().map(|source| context.read_graph(source, "before")).transpose()?;
    let statistics =
        command.verify_stats.as_ref().map(|source| read_statistics(source, context)).transpose()?;
    let view = View {
        title: &command.title,
        before: before.as_ref(),
        statistics: statistics.as_ref(),
        frame: command.frame,
        ..View::of(&graph)
    };
    let text = page(&view)?;
    let summary = summary(&graph);
    info!(
        "{}, {}: {} in use, {} undecided, {} rejected; {} kB",
        counted(graph.nodes.len(), "node"),
        counted(summary.landmark_edges, "landmark edge"),
        summary.in_use,
        summary.undecided,
        summary.rejected,
        text.len() / 1000
    );
    context.statistics.note("nodes", graph.nodes.len());
    context.statistics.note("landmark_edges", summary.landmark_edges);
    context.statistics.note("in_use", summary.in_use);
    context.statistics.note("undecided", summary.undecided);
    context.statistics.note("rejected", summary.rejected);
    context.statistics.note("bytes", text.len());
    context.write_bytes(text.as_bytes())?;
    Ok(Outcome::Done)
}

/// The statistics of posecut-verify: an object of JSON.
fn read_statistics(source: &Source, context: &mut Context) -> anyhow::Result<Map<String, Value>> {
    let (name, bytes) = context.read_bytes(source, "verify-stats")?;
    let statistics: Map<String, Value> = serde_json::from_slice(&bytes).with_context(|| {
        format!("{name}: is not a JSON object; give the file that posecut-verify wrote for --stats")
    })?;
    if statistics.get("stage").and_then(Value::as_str) != Some("verify") {
        warn!(
            "{name}: does not come from posecut-verify; the page shows what it finds of calibration and rivals"
        );
    }
    Ok(statistics)
}

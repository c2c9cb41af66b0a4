//! The command line of `posecut-convert`: converts other tools' files to pose-graph JSON Lines and back.

use std::path::Path;
use std::process::ExitCode;

use crate::input::{Reading, ReadingOptions, read};
use crate::output::{WritingOptions, write};
use crate::{FileFormat, evo};
use anyhow::bail;
use clap::Parser;
use posecut_evaluate::alignment::Freedom;
use posecut_graph::PoseGraph;
use posecut_stage::{
    CommonArguments, Context, Doubt, Examples, Identity, Outcome, Phase, Place, Source, info, run_with_doubts,
};

#[derive(Parser)]
struct Command {
    /// The file to read; `-` is standard input. Several files, such as one per robot or session, become one graph
    #[arg(value_name = "INPUT", default_value = "-")]
    inputs: Vec<Source>,

    /// Write this format [default: by the name of the output, JSON Lines for standard output]
    #[arg(long, value_enum)]
    to: Option<FileFormat>,

    #[command(flatten)]
    reading: ReadingOptions,

    #[command(flatten)]
    writing: WritingOptions,

    /// Compare with the poses of this graph, for evo's results
    #[arg(long, value_name = "FILE")]
    reference: Option<Source>,

    /// Align by these motions, for evo's results [default: se2 for planar graphs, se3 for spatial graphs]
    #[arg(long, value_enum)]
    align: Option<Freedom>,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    ("Convert a g2o file", "posecut convert graph.g2o -o graph.jsonl"),
    ("Join the files of two robots", "posecut convert first.g2o second.g2o --renumber -o graph.jsonl"),
    (
        "Add the landmark edges of a table to a trajectory in the plane",
        "posecut convert poses.tum --dimension 2 --odometry-from-poses \\\n    --sigma-translation 0.05 --sigma-rotation 0.01 --closures closures.csv \\\n    -o graph.jsonl",
    ),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "convert",
        version: env!("CARGO_PKG_VERSION"),
        about: "Convert g2o, TORO, JRL, TUM and KITTI files to pose-graph JSON Lines and back",
        place: Place(Phase::Graphs, 40),
        examples: EXAMPLES,
    };
    run_with_doubts::<Command>(
        identity,
        &[Doubt::CovarianceInvented],
        |command| &command.common,
        |command, context| {
            let to = match (command.common.output.path(), command.to) {
                (_, Some(format)) => format,
                (None, None) => FileFormat::Jsonl,
                (Some(path), None) => by_name(path)?,
            };
            let Reading { mut graph, name, .. } = read(&command.inputs, &command.reading, context)?;
            if graph.edges.is_empty() && holds_graphs(to) {
                info!(
                    "{name}: there are no edges, so there is nothing to optimise; --odometry-from-poses makes odometry of the poses"
                );
            }
            context.statistics.note("nodes", graph.nodes.len());
            context.statistics.note("edges", graph.edges.len());
            match to {
                FileFormat::Jsonl => {
                    context.record_provenance(&mut graph, &command.reading, None)?;
                    context.write_graph(&graph)?;
                }
                FileFormat::Evo => {
                    let bytes = compare(command, &graph, context)?;
                    context.write_bytes(&bytes)?;
                }
                _ => {
                    let bytes = write(&graph, to, &command.writing, context)?;
                    context.write_bytes(&bytes)?;
                }
            }
            Ok(Outcome::Done)
        },
    )
}

/// Whether files of this format have edges.
fn holds_graphs(format: FileFormat) -> bool {
    !matches!(format, FileFormat::Tum | FileFormat::Kitti | FileFormat::Evo)
}

fn by_name(path: &Path) -> anyhow::Result<FileFormat> {
    let Some(format) = FileFormat::of_name(path) else {
        bail!(
            "{}: the name does not determine the format; set --to to jsonl, g2o, toro, jrl, tum, kitti or evo",
            path.display()
        );
    };
    Ok(format)
}

fn compare(command: &Command, graph: &PoseGraph, context: &mut Context) -> anyhow::Result<Vec<u8>> {
    let Some(reference) = &command.reference else {
        bail!("evo's results compare two graphs; name the second one with --reference FILE");
    };
    let reference = context.read_graph(reference, "reference")?;
    Ok(evo::write(graph, &reference, command.align, command.writing.only_session.as_deref())?)
}

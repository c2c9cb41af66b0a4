//! `posecut-convert`: converts other tools' files to pose-graph JSON Lines and back.

use std::path::Path;
use std::process::ExitCode;

use anyhow::bail;
use clap::Parser;
use posecut_convert::tum::Poses;
use posecut_convert::{FileFormat, Repair, evo, g2o, kitti, toro, tum};
use posecut_evaluate::alignment::Freedom;
use posecut_graph::{InputDigest, PoseGraph};
use posecut_stage::{
    CommonArguments, Context, Doubt, Identity, Outcome, Phase, Place, Source, counted, info, open,
    run_with_doubts, warn,
};
use serde::Serialize;

#[derive(Parser)]
struct Command {
    /// The file to read; `-` is standard input. Several g2o or TORO files (such as one per robot) become one graph
    #[arg(value_name = "INPUT", default_value = "-")]
    inputs: Vec<Source>,

    /// Read this format [default: by the name of the input, JSON Lines for standard input]
    #[arg(long, value_enum)]
    from: Option<FileFormat>,

    /// Write this format [default: by the name of the output, JSON Lines for standard output]
    #[arg(long, value_enum)]
    to: Option<FileFormat>,

    #[command(flatten)]
    reading: Reading,

    /// Write rejected edges too, as if they were in use
    #[arg(long)]
    keep_rejected: bool,

    /// Write trajectories of these poses
    #[arg(long, value_enum, default_value_t = Poses::Estimate)]
    poses: Poses,

    /// Write the trajectory of this session only
    #[arg(long, value_name = "NAME")]
    only_session: Option<String>,

    /// Compare with the poses of this graph, for evo's results
    #[arg(long, value_name = "FILE")]
    reference: Option<Source>,

    /// Align by these motions, for evo's results [default: se2 for planar graphs, se3 for spatial graphs]
    #[arg(long, value_enum)]
    align: Option<Freedom>,

    #[command(flatten)]
    common: CommonArguments,
}

#[derive(clap::Args, Serialize)]
struct Reading {
    /// Use this session name for files that name no session
    #[arg(long, value_name = "NAME", default_value = "0")]
    session: String,

    /// Set negative eigenvalues of information matrices to zero instead of refusing them
    #[arg(long)]
    repair_information: bool,

    /// Skip lines of unknown type instead of refusing them
    #[arg(long)]
    skip_unknown: bool,
}

fn main() -> ExitCode {
    let identity = Identity {
        name: "convert",
        version: env!("CARGO_PKG_VERSION"),
        about: "Convert g2o, TORO, TUM and KITTI files to pose-graph JSON Lines and back",
        place: Place(Phase::Graphs, 40),
    };
    run_with_doubts::<Command>(
        identity,
        &[Doubt::CovarianceInvented],
        |command| &command.common,
        |command, context| {
            let from = match (&command.inputs[0], command.from) {
                (_, Some(format)) => format,
                (Source::Standard, None) => FileFormat::Jsonl,
                (Source::File(path), None) => by_name(path, "--from")?,
            };
            let to = match (command.common.output.path(), command.to) {
                (_, Some(format)) => format,
                (None, None) => FileFormat::Jsonl,
                (Some(path), None) => by_name(path, "--to")?,
            };
            let mut graph = read(command, from, context)?;
            context.statistics.note("nodes", graph.nodes.len());
            context.statistics.note("edges", graph.edges.len());
            if to == FileFormat::Jsonl {
                context.record_provenance(&mut graph, &command.reading, None)?;
                context.write_graph(&graph)?;
            } else {
                let bytes = write(command, to, &graph, context)?;
                context.write_bytes(&bytes)?;
            }
            Ok(Outcome::Done)
        },
    )
}

fn by_name(path: &Path, option: &str) -> anyhow::Result<FileFormat> {
    let Some(format) = FileFormat::of_name(path) else {
        bail!(
            "{}: the name does not determine the format; set {option} to jsonl, g2o, toro, tum, kitti or evo",
            path.display()
        );
    };
    Ok(format)
}

fn read(command: &Command, from: FileFormat, context: &mut Context) -> anyhow::Result<PoseGraph> {
    if matches!(from, FileFormat::G2o | FileFormat::Toro) {
        return read_graph_files(command, from, context);
    }
    if let Some(second) = command.inputs.get(1) {
        bail!(
            "{second}: only g2o and TORO files can be joined; convert one file at a time, and join session graphs with posecut-construct"
        );
    }
    if from == FileFormat::Jsonl {
        return context.read_graph(&command.inputs[0], "graph");
    }
    let mut input = open(&command.inputs[0])?;
    let name = input.name.clone();
    let session = command.reading.session.as_str();
    let graph = match from {
        FileFormat::Tum => tum::read(&name, &mut input, session)?,
        FileFormat::Evo => bail!(
            "{name}: evo's results contain errors, not a graph, and can only be written; read the trajectories that they compare"
        ),
        _ => kitti::read(&name, &mut input, session)?,
    };
    context.inputs.push(InputDigest { name: "input".to_owned(), sha256: input.finish()? });
    Ok(graph)
}

/// Reads one or several g2o or TORO files.
fn read_graph_files(command: &Command, from: FileFormat, context: &mut Context) -> anyhow::Result<PoseGraph> {
    let mut inputs = command.inputs.iter().map(open).collect::<anyhow::Result<Vec<_>>>()?;
    let name = inputs[0].name.clone();
    let options = g2o::ReadOptions {
        session: command.reading.session.clone(),
        repair: if command.reading.repair_information { Repair::Clamp } else { Repair::Refuse },
        skip_unknown: command.reading.skip_unknown,
    };
    let files = inputs.iter_mut().map(|input| (input.name.clone(), input)).collect();
    let (graph, summary) = if from == FileFormat::Toro {
        toro::read_several(files, &options)?
    } else {
        g2o::read_several(files, &options)?
    };
    report(&name, &summary, context);
    for input in inputs {
        context.inputs.push(InputDigest { name: "input".to_owned(), sha256: input.finish()? });
    }
    Ok(graph)
}

fn report(name: &str, summary: &g2o::ReadSummary, context: &mut Context) {
    if summary.repaired > 0 {
        context.doubt(
            Doubt::CovarianceInvented,
            format!(
                "{name}: {} not positive semidefinite, so negative eigenvalues are set to zero; export the sensor's own covariances",
                match summary.repaired {
                    1 => "1 information matrix is".to_owned(),
                    count => format!("{count} information matrices are"),
                }
            ),
        );
    }
    if let Some((line, from, to)) = summary.first_open {
        warn!(
            "{name}: {} with an information matrix that may be singular within the rounding of its printed digits (first: edge {from} {to} in line {line}); used unchanged",
            counted(summary.open, "edge")
        );
    }
    for (tag, count) in &summary.skipped {
        warn!("{name}: skipped {} of type {tag}", counted(*count, "line"));
    }
    if summary.without_vertex > 0 {
        let nodes = counted(summary.without_vertex, "node");
        info!("{name}: added {nodes} without a pose, because edges name them but no vertex line does");
    }
    context.statistics.note("repaired_information", summary.repaired);
    context.statistics.note("open_information", summary.open);
    context.statistics.note("skipped_lines", summary.skipped.values().sum::<usize>());
    context.statistics.note("nodes_without_vertex", summary.without_vertex);
}

fn write(
    command: &Command,
    to: FileFormat,
    graph: &PoseGraph,
    context: &mut Context,
) -> anyhow::Result<Vec<u8>> {
    let session = command.only_session.as_deref();
    Ok(match to {
        FileFormat::Tum => tum::write(graph, command.poses, session)?,
        FileFormat::Kitti => kitti::write(graph, command.poses, session)?,
        FileFormat::Evo => {
            let Some(reference) = &command.reference else {
                bail!("evo's results compare two graphs; name the second one with --reference FILE");
            };
            let reference = context.read_graph(reference, "reference")?;
            evo::write(graph, &reference, command.align, session)?
        }
        FileFormat::G2o | FileFormat::Toro | FileFormat::Jsonl => {
            let (bytes, summary) = if to == FileFormat::Toro {
                toro::write(graph, command.keep_rejected)?
            } else {
                g2o::write(graph, command.keep_rejected)
            };
            if summary.rejected + summary.unmeasured > 0 {
                info!(
                    "omitted {} and {} without a measurement (--keep-rejected writes rejected edges)",
                    counted(summary.rejected, "rejected edge"),
                    counted(summary.unmeasured, "edge")
                );
            }
            context.statistics.note("rejected_left_out", summary.rejected);
            context.statistics.note("unmeasured_left_out", summary.unmeasured);
            bytes
        }
    })
}

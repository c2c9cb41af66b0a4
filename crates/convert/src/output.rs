//! Writes a graph in any format that holds one.

use anyhow::bail;
use posecut_graph::PoseGraph;
use posecut_stage::{Context, counted, info, warn};

use crate::tum::Poses;
use crate::{FileFormat, g2o, jrl, kitti, toro, tum};

/// How a graph is written in other formats than JSON Lines.
#[derive(Clone, Debug, clap::Args)]
pub struct WritingOptions {
    /// Write rejected edges too, as if they were in use
    #[arg(long)]
    pub keep_rejected: bool,

    /// Write trajectories of these poses
    #[arg(long, value_enum, default_value_t = Poses::Estimate)]
    pub poses: Poses,

    /// Write the trajectory of this session only
    #[arg(long, value_name = "NAME")]
    pub only_session: Option<String>,
}

impl Default for WritingOptions {
    fn default() -> Self {
        Self { keep_rejected: false, poses: Poses::Estimate, only_session: None }
    }
}

/// The content of a file of that format with this graph. What the format cannot hold is reported on standard error and in the
/// statistics. evo's results need a second graph and are refused ([`crate::evo::write`]).
pub fn write(
    graph: &PoseGraph,
    format: FileFormat,
    options: &WritingOptions,
    context: &mut Context,
) -> anyhow::Result<Vec<u8>> {
    let session = options.only_session.as_deref();
    let (bytes, summary) = match format {
        FileFormat::Jsonl => {
            let mut bytes = Vec::new();
            graph.write(&mut bytes)?;
            return Ok(bytes);
        }
        FileFormat::Tum => return Ok(tum::write(graph, options.poses, session)?),
        FileFormat::Kitti => return Ok(kitti::write(graph, options.poses, session)?),
        FileFormat::Evo => {
            bail!("evo's results compare two graphs; name the second one with --reference FILE")
        }
        FileFormat::Jrl => return write_dataset(graph, options, context),
        FileFormat::G2o => g2o::write(graph, options.keep_rejected),
        FileFormat::Toro => toro::write(graph, options.keep_rejected)?,
    };
    report(summary.rejected, summary.unmeasured, context);
    report_priors(summary.rejected_priors, summary.priors, context);
    Ok(bytes)
}

fn write_dataset(
    graph: &PoseGraph,
    options: &WritingOptions,
    context: &mut Context,
) -> anyhow::Result<Vec<u8>> {
    let (bytes, summary) = jrl::write(graph, options.keep_rejected)?;
    for (letter, session) in &summary.renamed {
        info!("session \"{session}\" became robot {letter}, because JRL names robots by letters");
    }
    if summary.unlabelled > 0 {
        info!(
            "left out all labels, because {} no label and JRL would call them correct",
            match summary.unlabelled {
                1 => "1 landmark edge has".to_owned(),
                count => format!("{count} landmark edges have"),
            }
        );
    }
    if summary.anchors > 0 {
        info!(
            "{} on the first pose of a robot, which readers of JRL take for the anchor of the map",
            counted(summary.anchors, "prior")
        );
    }
    report(summary.rejected, summary.unmeasured, context);
    report_priors(summary.rejected_priors, summary.positions, context);
    Ok(bytes)
}

/// Reports the priors that are not in the file.
fn report_priors(rejected: usize, impossible: usize, context: &mut Context) {
    if rejected > 0 {
        info!("omitted {} (--keep-rejected writes them)", counted(rejected, "rejected prior"));
        context.statistics.note("rejected_priors_left_out", rejected);
    }
    if impossible > 0 {
        warn!(
            "omitted {}, which the format cannot hold; write g2o or JSON Lines to keep them",
            counted(impossible, "prior")
        );
        context.statistics.note("priors_left_out", impossible);
    }
}

/// Reports the edges that are not in the file.
fn report(rejected: usize, unmeasured: usize, context: &mut Context) {
    if rejected + unmeasured > 0 {
        info!(
            "omitted {} and {} without a measurement (--keep-rejected writes rejected edges)",
            counted(rejected, "rejected edge"),
            counted(unmeasured, "edge")
        );
    }
    context.statistics.note("rejected_left_out", rejected);
    context.statistics.note("unmeasured_left_out", unmeasured);
}

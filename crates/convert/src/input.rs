//! Reads graph files of any format, for programs that take other tools' files.

mod opened;
mod options;
mod report;
mod trajectory;

use anyhow::bail;
use posecut_graph::PoseGraph;
use posecut_stage::{Context, Source, counted, info};

use crate::join::{join, names};
use crate::trajectory::{self as trajectories, Axes};
use crate::{FileFormat, Repair, closures, g2o, jrl, kitti, toro, tum};
use opened::Opened;
pub use options::ReadingOptions;
pub use trajectory::TrajectoryOptions;

/// A graph that was read.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The graph.
    pub graph: PoseGraph,
    /// The format of its files.
    pub format: FileFormat,
    /// What messages call the first file.
    pub name: String,
}

/// Reads one graph from one or several files. The format is that of `options`, else that of the content, else that of the file's
/// name. What was repaired, added or inferred is reported on standard error, in the statistics and as a doubt.
pub fn read(inputs: &[Source], options: &ReadingOptions, context: &mut Context) -> anyhow::Result<Reading> {
    if options.closures == Some(Source::Standard) && inputs.contains(&Source::Standard) {
        bail!("the graph and --closures cannot both be standard input; name a file");
    }
    let open = |source| Opened::open(source, options.from, context);
    let mut files = inputs.iter().map(open).collect::<anyhow::Result<Vec<_>>>()?;
    let Some(first) = files.first() else { bail!("no input is named; name a file, or - for standard input") };
    let (format, name) = (first.format, first.name.clone());
    if let Some(other) = files.iter().find(|file| file.format != format) {
        bail!(
            "{}: its format is {}, but that of {name} is {format}; convert them to one format first",
            other.name,
            other.format
        );
    }
    let joins = files.len() > 1 && (options.renumber || format.is_trajectory());
    let mut graph = if joins || (options.renumber && format != FileFormat::Jsonl) {
        let names = names(inputs, &options.session)?;
        let graphs = names.into_iter().zip(&mut files).map(|(session, file)| {
            let files = std::slice::from_mut(file);
            Ok((session.clone(), read_files(files, format, &session, options, context)?))
        });
        join(graphs.collect::<anyhow::Result<Vec<_>>>()?)?
    } else {
        if let [_, second, ..] = options.session.as_slice() {
            bail!(
                "--session names several sessions ({second}, …), but the files become one graph with the ids that they have; give one name, or one for each file with --renumber"
            );
        }
        read_files(&mut files, format, options.session(), options, context)?
    };
    for file in files {
        file.finish(context)?;
    }
    complete(&mut graph, &name, format, options, context)?;
    Ok(Reading { graph, format, name })
}

/// Reads one file, or several files whose ids are unique.
fn read_files(
    files: &mut [Opened],
    format: FileFormat,
    session: &str,
    options: &ReadingOptions,
    context: &mut Context,
) -> anyhow::Result<PoseGraph> {
    let name = files[0].name.clone();
    if let [_, second, ..] = files
        && !matches!(format, FileFormat::G2o | FileFormat::Toro)
    {
        bail!(
            "{}: several {format} files cannot be joined as they are; set --renumber to make a session of each file",
            second.name
        );
    }
    Ok(match format {
        FileFormat::Jsonl => PoseGraph::read(&name, &mut files[0])?,
        FileFormat::G2o | FileFormat::Toro => {
            let reading = g2o::ReadOptions {
                session: session.to_owned(),
                repair: if options.repair_information { Repair::Clamp } else { Repair::Refuse },
                skip_unknown: options.skip_unknown,
                odometry: options.odometry,
            };
            let files = files.iter_mut().map(|file| (file.name.clone(), file)).collect();
            let (graph, summary) = match format {
                FileFormat::Toro => toro::read_several(files, &reading)?,
                _ => g2o::read_several(files, &reading)?,
            };
            report::vertices_and_edges(&name, &summary, context);
            graph
        }
        FileFormat::Jrl => {
            let reading = jrl::ReadOptions {
                session: session.to_owned(),
                skip_unknown: options.skip_unknown,
                odometry: options.odometry,
            };
            let bytes = files[0].whole()?;
            let (graph, summary) = jrl::read(&name, &bytes, &reading)?;
            report::dataset(&name, &summary, context);
            graph
        }
        FileFormat::Tum => tum::read(&name, &mut files[0], session)?,
        FileFormat::Kitti => kitti::read(&name, &mut files[0], session)?,
        FileFormat::Evo => bail!(
            "{name}: evo's results contain errors, not a graph, and can only be written; read the trajectories that they compare"
        ),
    })
}

/// Projects the graph, and adds odometry and closures, as the options say.
fn complete(
    graph: &mut PoseGraph,
    name: &str,
    format: FileFormat,
    options: &ReadingOptions,
    context: &mut Context,
) -> anyhow::Result<()> {
    let trajectory = &options.trajectory;
    if trajectory.dimension.is_some() {
        let usual = if format == FileFormat::Kitti { Axes::Camera } else { Axes::Robot };
        trajectories::project(graph, trajectory.axes.unwrap_or(usual), trajectory.flatten)
            .map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
    }
    if trajectory.odometry_from_poses
        && let Some((translation, rotation)) = trajectory.sigma_translation.zip(trajectory.sigma_rotation)
    {
        let added = trajectories::add_odometry(graph, translation, rotation)?;
        info!("{name}: added {} between consecutive poses", counted(added, "odometry edge"));
    }
    if let Some(source) = &options.closures {
        let (file, table) = context.read_bytes(source, "closures")?;
        let added = closures::add(graph, &file, &table, &options.closure_options)?;
        info!(
            "{file}: added {} ({} with a label, {} without a measurement)",
            counted(added.closures, "landmark edge"),
            added.labelled,
            added.unmeasured
        );
        context.statistics.note("closures", added.closures);
    }
    Ok(())
}

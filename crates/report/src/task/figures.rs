//! The subcommands that draw graphs.

use std::path::PathBuf;

use crate::consistency::matrix;
use crate::figure::plotting::charts;
use crate::figure::{self, Frame, components, error, graphs, trajectories};
use anyhow::{Context as _, bail};
use clap::Args;
use posecut_graph::PoseGraph;
use posecut_stage::{CommonArguments, Context, Source};

/// Options of `trajectories`.
#[derive(Args)]
pub(crate) struct Trajectories {
    /// Session graphs
    #[arg(required = true)]
    graphs: Vec<PathBuf>,

    /// Choose how coordinates are drawn
    #[arg(long, value_enum, default_value_t = Frame::Ned)]
    frame: Frame,
}

impl Trajectories {
    pub(crate) fn write(&self, common: &CommonArguments, context: &mut Context) -> anyhow::Result<Vec<u8>> {
        let mut named = Vec::new();
        for path in &self.graphs {
            let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            let graph = context.read_graph(&Source::File(path.clone()), "graph")?;
            let name = graph.sessions().first().map_or(name, |&session| session.to_owned());
            named.push((name, graph));
        }
        charts(&trajectories::panels(&named, self.frame), 2)?.write(&extension(common)?)
    }
}

/// Options of `graphs`.
#[derive(Args)]
pub(crate) struct Graphs {
    /// An optimised graph and the title of its panel
    #[arg(required = true, value_name = "TITLE=FILE")]
    panels: Vec<String>,

    /// Use this reference graph
    #[arg(long, value_name = "FILE")]
    reference: Option<Source>,

    /// Choose how coordinates are drawn
    #[arg(long, value_enum, default_value_t = Frame::Ned)]
    frame: Frame,
}

impl Graphs {
    pub(crate) fn write(&self, common: &CommonArguments, context: &mut Context) -> anyhow::Result<Vec<u8>> {
        let reference =
            self.reference.as_ref().map(|source| context.read_graph(source, "reference")).transpose()?;
        let panels = self
            .panels
            .iter()
            .map(|named| {
                let (title, graph) = titled(named, context)?;
                Ok(graphs::panel(title, &graph, reference.as_ref(), self.frame))
            })
            .collect::<anyhow::Result<Vec<_>>>()?;
        charts(&panels, panels.len())?.write(&extension(common)?)
    }
}

/// Options of `consistency`.
#[derive(Args)]
pub(crate) struct Consistency {
    /// A graph that PCM has processed and the title of its matrix
    #[arg(required = true, value_name = "TITLE=FILE")]
    panels: Vec<String>,
}

impl Consistency {
    pub(crate) fn write(&self, common: &CommonArguments, context: &mut Context) -> anyhow::Result<Vec<u8>> {
        let mut shown = Vec::new();
        for named in &self.panels {
            let (title, graph) = titled(named, context)?;
            let matrix = matrix(&graph).with_context(|| named.clone())?.with_context(|| {
                format!("{named}: PCM has not processed this graph; name the output of posecut-pcm or of a later stage")
            })?;
            shown.push((title.to_owned(), graph, matrix));
        }
        figure::consistency::drawing(&shown)?.write(&extension(common)?)
    }
}

/// Options of `components`.
#[derive(Args)]
pub(crate) struct Components {
    /// A graph that the multicut has processed and the title of its panels
    #[arg(required = true, value_name = "TITLE=FILE")]
    panels: Vec<String>,

    /// Choose how coordinates are drawn
    #[arg(long, value_enum, default_value_t = Frame::Ned)]
    frame: Frame,
}

impl Components {
    pub(crate) fn write(&self, common: &CommonArguments, context: &mut Context) -> anyhow::Result<Vec<u8>> {
        let mut panels = Vec::new();
        for named in &self.panels {
            let (title, graph) = titled(named, context)?;
            let landmarks = components::landmarks(&graph).with_context(|| {
                format!(
                    "{named}: no node has a landmark; name the output of posecut-multicut or of a later stage"
                )
            })?;
            panels.extend(components::panels(title, &graph, &landmarks, self.frame));
        }
        charts(&panels, 2)?.write(&extension(common)?)
    }
}

/// Options of `error`.
#[derive(Args)]
pub(crate) struct Error {
    /// An optimised graph and the name of its method
    #[arg(required = true, value_name = "NAME=FILE")]
    estimates: Vec<String>,

    /// Use this reference graph
    #[arg(long, value_name = "FILE", required = true)]
    reference: Source,

    /// Write this title above the chart
    #[arg(long, value_name = "TEXT", default_value = "Error of each pose along the session")]
    title: String,
}

impl Error {
    pub(crate) fn write(&self, common: &CommonArguments, context: &mut Context) -> anyhow::Result<Vec<u8>> {
        let reference = context.read_graph(&self.reference, "reference")?;
        let mut estimates = Vec::new();
        for named in &self.estimates {
            let (name, graph) = titled(named, context)?;
            estimates.push((name.to_owned(), graph));
        }
        charts(&[error::panel(&self.title, &estimates, &reference)?], 1)?.write(&extension(common)?)
    }
}

fn titled<'a>(named: &'a str, context: &mut Context) -> anyhow::Result<(&'a str, PoseGraph)> {
    let Some((title, file)) = named.split_once('=') else {
        bail!("{named}: expected TITLE=FILE, such as PCM=pcm.jsonl");
    };
    Ok((title, context.read_graph(&Source::File(file.into()), "graph")?))
}

/// The format of a figure, by its file name.
pub(crate) fn extension(common: &CommonArguments) -> anyhow::Result<String> {
    let path = common
        .output
        .path()
        .context("a figure needs a file: name it with -o, ending in .svg, .pdf or .png")?;
    Ok(path.extension().map(|extension| extension.to_string_lossy().into_owned()).unwrap_or_default())
}

//! The subcommands that draw graphs.

use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::Args;
use posecut_graph::PoseGraph;
use posecut_report::figure::{Frame, graphs, plotting, trajectories};
use posecut_stage::{CommonArguments, Context, Source};

/// Options of `trajectories`.
#[derive(Args)]
pub(crate) struct Trajectories {
    /// Session graphs
    #[arg(required = true)]
    graphs: Vec<PathBuf>,

    /// How coordinates lie on paper
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
        plotting::draw(&trajectories::panels(&named, self.frame), 2, self.frame, &extension(common)?)
    }
}

/// Options of `graphs`.
#[derive(Args)]
pub(crate) struct Graphs {
    /// TITLE=FILE: an optimised graph and its panel's title
    #[arg(required = true, value_name = "TITLE=FILE")]
    panels: Vec<String>,

    /// The reference graph
    #[arg(long, value_name = "FILE")]
    reference: Option<Source>,

    /// How coordinates lie on paper
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
        plotting::draw(&panels, panels.len(), self.frame, &extension(common)?)
    }
}

fn titled<'a>(named: &'a str, context: &mut Context) -> anyhow::Result<(&'a str, PoseGraph)> {
    let Some((title, file)) = named.split_once('=') else {
        bail!("{named}: expected TITLE=FILE, such as PCM=pcm.jsonl");
    };
    Ok((title, context.read_graph(&Source::File(file.into()), "graph")?))
}

/// The format of a figure, by the name of its file.
pub(crate) fn extension(common: &CommonArguments) -> anyhow::Result<String> {
    let path = common
        .output
        .path()
        .context("a figure needs a file: name it with -o, ending in .svg, .pdf or .png")?;
    Ok(path.extension().map(|extension| extension.to_string_lossy().into_owned()).unwrap_or_default())
}

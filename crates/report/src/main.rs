//! `posecut-report`: tables and figures of experiments.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::{Parser, Subcommand, ValueEnum};
use posecut_report::figure::{Frame, graphs, plotting, trajectories};
use posecut_report::published::Published;
use posecut_report::{results, table};
use posecut_stage::{CommonArguments, Context, Identity, Outcome, Source, run};

#[derive(Parser)]
struct Command {
    #[command(subcommand)]
    task: Task,

    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Subcommand)]
enum Task {
    /// Methods against sessions, mean and spread over seeds, beside published figures
    Table {
        /// Results of posecut-evaluate, or directories searched for *.result.json
        #[arg(required = true)]
        results: Vec<PathBuf>,

        /// How the table is written
        #[arg(long, value_enum, default_value_t = Format::Markdown)]
        format: Format,

        /// Published figures to stand beside ours (TOML)
        #[arg(long, value_name = "FILE")]
        published: Option<PathBuf>,

        /// Methods in the order of rows
        #[arg(long, value_name = "NAMES", value_delimiter = ',')]
        methods: Vec<String>,

        /// Sessions asked for that have no data
        #[arg(long, value_name = "NAMES", value_delimiter = ',')]
        missing: Vec<String>,
    },
    /// Where the sessions went, one panel a graph (SVG or PNG by the name given to -o)
    Trajectories {
        /// Session graphs
        #[arg(required = true)]
        graphs: Vec<PathBuf>,

        /// How coordinates lie on paper
        #[arg(long, value_enum, default_value_t = Frame::Ned)]
        frame: Frame,
    },
    /// Optimised graphs over their reference, with false edges visible (SVG or PNG by the name given to -o)
    Graphs {
        /// TITLE=FILE: an optimised graph and its panel's title
        #[arg(required = true, value_name = "TITLE=FILE")]
        panels: Vec<String>,

        /// The reference graph
        #[arg(long, value_name = "FILE")]
        reference: Option<Source>,

        /// How coordinates lie on paper
        #[arg(long, value_enum, default_value_t = Frame::Ned)]
        frame: Frame,
    },
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// For people and README files
    Markdown,
    /// One row a run
    Csv,
    /// For papers
    Latex,
}

fn main() -> ExitCode {
    let identity = Identity {
        name: "report",
        version: env!("CARGO_PKG_VERSION"),
        about: "Write tables and figures of experiments",
    };
    run::<Command>(
        identity,
        |command| &command.common,
        |command, context| {
            let bytes = match &command.task {
                Task::Table { results, format, published, methods, missing } => {
                    write_table(results, *format, published.as_ref(), methods, missing)?
                }
                Task::Trajectories { graphs, frame } => {
                    let mut named = Vec::new();
                    for path in graphs {
                        let name = path
                            .file_stem()
                            .map(|stem| stem.to_string_lossy().into_owned())
                            .unwrap_or_default();
                        let graph = context.read_graph(&Source::File(path.clone()), "graph")?;
                        let name = graph.sessions().first().map_or(name, |&session| session.to_owned());
                        named.push((name, graph));
                    }
                    plotting::draw(
                        &trajectories::panels(&named, *frame),
                        2,
                        *frame,
                        &extension(&command.common)?,
                    )?
                }
                Task::Graphs { panels, reference, frame } => {
                    let reference = reference
                        .as_ref()
                        .map(|source| context.read_graph(source, "reference"))
                        .transpose()?;
                    let panels = panels
                        .iter()
                        .map(|named| {
                            let (title, graph) = titled(named, context)?;
                            Ok(graphs::panel(title, &graph, reference.as_ref(), *frame))
                        })
                        .collect::<anyhow::Result<Vec<_>>>()?;
                    plotting::draw(&panels, panels.len(), *frame, &extension(&command.common)?)?
                }
            };
            context.write_bytes(&bytes)?;
            Ok(Outcome::Done)
        },
    )
}

fn write_table(
    paths: &[PathBuf],
    format: Format,
    published: Option<&PathBuf>,
    methods: &[String],
    missing: &[String],
) -> anyhow::Result<Vec<u8>> {
    let results = results::read_all(paths)?;
    let published = published.map(|path| Published::read(path)).transpose()?.unwrap_or_default();
    let tables = table::tables(&results, methods, missing);
    Ok(match format {
        Format::Markdown => table::markdown(&tables, &published).into_bytes(),
        Format::Latex => table::latex(&tables, &published).into_bytes(),
        Format::Csv => table::write_csv(&results)?,
    })
}

fn titled<'a>(named: &'a str, context: &mut Context) -> anyhow::Result<(&'a str, posecut_graph::PoseGraph)> {
    let Some((title, file)) = named.split_once('=') else {
        bail!("{named}: expected TITLE=FILE, such as PCM=pcm.jsonl");
    };
    Ok((title, context.read_graph(&Source::File(file.into()), "graph")?))
}

/// The format of a figure, by the name of its file.
fn extension(common: &CommonArguments) -> anyhow::Result<String> {
    let path =
        common.output.path().context("a figure needs a file: name it with -o, ending in .svg or .png")?;
    Ok(path.extension().map(|extension| extension.to_string_lossy().into_owned()).unwrap_or_default())
}

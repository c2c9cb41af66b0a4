//! Solves a signed graph and writes the labels of its nodes.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use posecut_multicut::stage::solver::{SolverOptions, note};
use posecut_multicut::{Graph, read_mc, solve};
use posecut_stage::{Context, Outcome, Source, counted, info, warn};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The signed graph to read (may be compressed): a line MULTICUT, then a line `u v cost` per edge; `-` is standard input
    #[arg(value_name = "INSTANCE", default_value = "-")]
    instance: Source,

    #[command(flatten)]
    solver: SolverOptions,

    /// Write a certificate of the lower bound, which `verify` checks
    #[arg(long, value_name = "FILE", help_heading = "Proof")]
    certificate: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, context: &mut Context) -> anyhow::Result<Outcome> {
    let options = arguments.solver.options(arguments.certificate.is_some())?;
    if let Some(path) = &arguments.certificate {
        context.check_further_output("--certificate", path)?;
    }
    let graph = read(&arguments.instance)?;
    let solution = solve(&graph, &options);
    if !graph.has_repulsive_edges() && !graph.edges().is_empty() {
        info!("no edge has a negative cost, so nothing is cut");
    }
    if graph.self_loops() > 0 {
        warn!("{} ignored: a self-loop cannot be cut", counted(graph.self_loops(), "self-loop"));
    }
    let clusters = solution.labels.iter().max().map_or(0, |&label| label as usize + 1);
    info!("objective {}, {}", solution.objective, counted(clusters, "cluster"));
    let statistics = &mut context.statistics;
    statistics.note("nodes", graph.node_count());
    statistics.note("edges", graph.edges().len());
    statistics.note("self_loops", graph.self_loops());
    statistics.note("clusters", clusters);
    note(&solution, options.solver, context);
    if let (Some(path), Some(certificate)) = (&arguments.certificate, &solution.certificate) {
        posecut_stage::write_atomically(path, |mut writer| Ok(certificate.write(&mut writer)?))?;
    }
    context.write_bytes(lines(&solution.labels).as_bytes())?;
    Ok(Outcome::Done)
}

fn read(source: &Source) -> anyhow::Result<Graph> {
    let input = posecut_stage::open(source)?;
    let name = input.name.clone();
    read_mc(input).context(name)
}

fn lines(labels: &[u32]) -> String {
    let mut text = String::with_capacity(labels.len() * 8);
    for label in labels {
        // Writing to memory cannot fail.
        let _ = writeln!(text, "{label}");
    }
    text
}

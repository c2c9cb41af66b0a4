//! The command line of `posecut-map`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::Parser;
use posecut_scan::Scans;
use posecut_stage::{
    CommonArguments, Context, Examples, Identity, Outcome, Phase, Place, Source, counted, info, run,
    write_atomically,
};

use crate::{Cell, Grid, Picture, ros};

#[derive(Parser)]
struct Command {
    /// The pose graph with scans, after posecut-optimize (JSON Lines, may be compressed); `-` is standard input
    #[arg(value_name = "GRAPH", default_value = "-")]
    graph: Source,

    /// Read the scans from this file instead of from the graph
    #[arg(long, value_name = "FILE")]
    scans: Option<Source>,

    /// Set the side of a cell, metres
    #[arg(long, value_name = "METRES", default_value_t = 0.05)]
    resolution: f64,

    /// Ignore beams that are longer than this, metres [default: use all]
    #[arg(long, value_name = "METRES")]
    max_range: Option<f64>,

    /// Also write a map for ROS: PREFIX.pgm and PREFIX.yaml
    #[arg(long, value_name = "PREFIX")]
    ros: Option<PathBuf>,

    /// Draw the map without the trajectories
    #[arg(long)]
    no_trajectory: bool,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    ("Draw the map of a log by its odometry", "posecut ingest robot.log | posecut map -o map.png"),
    ("Write a map for ROS, coarser", "posecut map optimized.jsonl --resolution 0.1 --ros map -o map.png"),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "map",
        version: env!("CARGO_PKG_VERSION"),
        about: "Draw the occupancy grid of a graph with laser scans as PNG, and write it as a map for ROS",
        place: Place(Phase::Results, 27),
        examples: EXAMPLES,
    };
    run::<Command>(identity, |command| &command.common, draw)
}

fn draw(command: &Command, context: &mut Context) -> anyhow::Result<Outcome> {
    let max_range = command.max_range.unwrap_or(f64::INFINITY);
    for (option, value) in [("--resolution", command.resolution), ("--max-range", max_range)] {
        if !(value > 0.0) || option == "--resolution" && value.is_infinite() {
            bail!("{option} is {value}, but must be a positive number of metres");
        }
    }
    let files = command.ros.as_deref().map(|prefix| ["pgm", "yaml"].map(|kind| with_suffix(prefix, kind)));
    for file in files.iter().flatten() {
        context.check_further_output("--ros", file)?;
    }
    let graph = context.read_graph(&command.graph, "graph")?;
    let file = command.scans.as_ref().map(|source| context.read_bytes(source, "scans")).transpose()?;
    let scans = Scans::of_file_or_graph(file.as_ref(), &graph)?;
    let grid = Grid::of_graph(&graph, &scans, command.resolution, max_range)?;
    let (occupied, free) = (grid.count(Cell::Occupied), grid.count(Cell::Free));
    info!(
        "{} in {} x {} cells of {} m: {free} free, {occupied} occupied",
        counted(scans.len(), "scan"),
        grid.width,
        grid.height,
        grid.resolution
    );
    context.statistics.note("scans", scans.len());
    context.statistics.note("width", grid.width);
    context.statistics.note("height", grid.height);
    context.statistics.note("resolution_m", grid.resolution);
    context.statistics.note("occupied", occupied);
    context.statistics.note("free", free);
    let mut picture = Picture::of_grid(&grid);
    if !command.no_trajectory {
        picture.draw_trajectories(&graph, &grid);
    }
    let mut bytes = Vec::new();
    picture.write(&mut bytes).context("the map cannot be written as PNG")?;
    context.write_bytes(&bytes)?;
    if let Some([pgm, yaml]) = &files {
        let name = pgm.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        write_atomically(pgm, |writer| Ok(ros::write_pgm(&grid, writer)?))?;
        write_atomically(yaml, |writer| Ok(ros::write_yaml(&grid, &name, writer)?))?;
    }
    Ok(Outcome::Done)
}

/// A path with a suffix after its name, which may have dots.
fn with_suffix(prefix: &Path, suffix: &str) -> PathBuf {
    let mut name = prefix.as_os_str().to_owned();
    name.push(".");
    name.push(suffix);
    name.into()
}

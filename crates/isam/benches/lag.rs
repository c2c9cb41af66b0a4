//! A simulated session of many poses with a lag: times per step, memory, and distance from the batch optimum.
//!
//! `cargo bench -p posecut-isam --bench lag [poses=N] [lag=N] [keep=N] [error=SHARE] [share=SHARE] [seed=N] [export=FILE.g2o]`
//!
//! A walk on a Manhattan grid with noisy odometry. A pose that returns to a place within the lag gets a landmark edge to an
//! earlier pose there, or only a `share` of these poses does. `export` writes the graph, with the batch optimum as poses. Prints one JSON object.

#![allow(clippy::print_stdout, reason = "a bench prints its figures")]

#[path = "lag/world.rs"]
mod world;

use std::io::Write as _;
use std::time::Instant;

use nalgebra::Matrix3;
use posecut_geometry::{LieGroup as _, SE2};
use posecut_isam::{IncrementalOptions, IncrementalSolver};
use posecut_optimize::{Edge, EdgeKind, Initialisation, Options, Problem, optimize};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Poses that arrive, with the edges that end at each.
type Arrivals = Vec<Vec<Edge<SE2, 3>>>;

struct Measured {
    milliseconds: Vec<f64>,
    solver: IncrementalSolver<SE2, 3>,
    /// Largest memory of cliques, priors and edges over all steps, bytes.
    largest: usize,
    largest_prior: usize,
    restarts: usize,
}

fn run(arrivals: &Arrivals, options: IncrementalOptions) -> Outcome<Measured> {
    let mut solver = IncrementalSolver::new(options)?;
    let mut milliseconds = Vec::with_capacity(arrivals.len());
    let (mut largest, mut largest_prior, mut restarts) = (0, 0, 0);
    for (node, edges) in arrivals.iter().enumerate() {
        let start = Instant::now();
        solver.add_pose(SE2::identity())?;
        for edge in edges {
            solver.add_edge(*edge)?;
        }
        let report = solver.update();
        std::hint::black_box(solver.estimate(node));
        milliseconds.push(start.elapsed().as_secs_f64() * 1e3);
        restarts += usize::from(report.restarted);
        if report.marginalised > 0 || node % 100 == 0 {
            largest = largest.max(solver.bytes());
            largest_prior = solver.prior_sizes().into_iter().fold(largest_prior, usize::max);
        }
    }
    Ok(Measured { milliseconds, solver, largest, largest_prior, restarts })
}

/// Root of the mean squared distance between the positions of these poses, metres.
fn distance(found: &[SE2], expected: &[SE2], nodes: impl Iterator<Item = usize> + Clone) -> f64 {
    let squares = nodes.clone().map(|node| {
        let [x, y, _] = found[node].translation();
        let [u, v, _] = expected[node].translation();
        (x - u).powi(2) + (y - v).powi(2)
    });
    (squares.sum::<f64>() / nodes.count() as f64).sqrt()
}

/// The same in the frame of the last pose: how far the window is bent, wherever it is. Without the fixed first pose.
fn shape(found: &[SE2], expected: &[SE2], nodes: &[usize]) -> f64 {
    let in_last = |poses: &[SE2]| -> Vec<SE2> {
        nodes[1..].iter().map(|&node| poses[poses.len() - 1].between(&poses[node])).collect()
    };
    distance(&in_last(found), &in_last(expected), 0..nodes.len() - 1)
}

fn export(path: &str, poses: &[SE2], arrivals: &Arrivals) -> Outcome<()> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    for (node, pose) in poses.iter().enumerate() {
        let [x, y, _] = pose.translation();
        writeln!(file, "VERTEX_SE2 {node} {x} {y} {}", pose.components()[2])?;
    }
    for edge in arrivals.iter().flatten() {
        let components = edge.measurement.components();
        let numbers: Vec<String> = components.iter().map(f64::to_string).collect();
        let (along, about) = (edge.information[(0, 0)], edge.information[(2, 2)]);
        writeln!(
            file,
            "EDGE_SE2 {} {} {} {along} 0 0 {along} 0 {about}",
            edge.from,
            edge.to,
            numbers.join(" ")
        )?;
    }
    Ok(file.flush()?)
}

fn main() -> Outcome<()> {
    let (mut poses, mut lag, mut keep, mut seed, mut file) = (100_000, 1000, None, 1, None);
    let mut error = IncrementalOptions::default().linearisation_error;
    let mut share = 1.0;
    for word in std::env::args().skip(1).filter(|word| !word.starts_with("--")) {
        match word.split_once('=') {
            Some(("poses", value)) => poses = value.parse()?,
            Some(("lag", value)) => lag = value.parse()?,
            Some(("keep", value)) => keep = Some(value.parse()?),
            Some(("error", value)) => error = value.parse()?,
            Some(("share", value)) => share = value.parse()?,
            Some(("seed", value)) => seed = value.parse()?,
            Some(("export", value)) => file = Some(value.to_owned()),
            _ => return Err(format!("there is no option '{word}'").into()),
        }
    }
    let arrivals = world::session(seed, poses, lag, share);
    let edges: Vec<Edge<SE2, 3>> = arrivals.iter().flatten().copied().collect();
    let landmark_edges = edges.iter().filter(|edge| edge.kind == EdgeKind::Landmark).count();
    let options = IncrementalOptions {
        lag: Some(lag),
        keep_every: keep,
        linearisation_error: error,
        ..IncrementalOptions::default()
    };
    let Measured { mut milliseconds, solver, largest, largest_prior, restarts } = run(&arrivals, options)?;

    let problem = Problem::new(solver.estimates(), edges)?;
    let batch = optimize(&problem, &Options { initialisation: Initialisation::Given, ..Options::default() });
    if let Some(path) = file {
        export(&path, &batch.poses, &arrivals)?;
    }
    let found = solver.estimates();
    let total = milliseconds.iter().sum::<f64>() * 1e-3;
    // The window fills first.
    milliseconds.drain(..(lag + lag / 10 + 1).min(poses / 2));
    milliseconds.sort_by(f64::total_cmp);
    let quantile = |share: f64| milliseconds[((milliseconds.len() - 1) as f64 * share).round() as usize];
    println!(
        "{{\"poses\":{poses},\"lag\":{lag},\"landmark_edges\":{landmark_edges},\"total_s\":{total:.3},\"median_ms\":{:.4},\"p99_ms\":{:.4},\"max_ms\":{:.3},\
         \"megabytes\":{:.3},\"largest_prior\":{largest_prior},\"restarts\":{restarts},\"live_m\":{:.3e},\"shape_m\":{:.3e},\"all_m\":{:.3e},\"truth_m\":{:.3e},\"batch_truth_m\":{:.3e},\
         \"cost\":{:.9e},\"batch_cost\":{:.9e},\"batch_converged\":{}}}",
        quantile(0.5),
        quantile(0.99),
        quantile(1.0),
        largest as f64 / 1e6,
        distance(&found, &batch.poses, solver.live_poses().iter().copied()),
        shape(&found, &batch.poses, solver.live_poses()),
        distance(&found, &batch.poses, 0..poses),
        distance(&found, &world::truth(seed, poses), 0..poses),
        distance(&batch.poses, &world::truth(seed, poses), 0..poses),
        solver.cost(),
        batch.cost,
        batch.converged,
    );
    Ok(())
}

/// Information matrix of all measurements: 0.05 m along each axis, 0.01 rad.
fn information() -> Matrix3<f64> {
    Matrix3::from_diagonal(&[400.0, 400.0, 1e4].into())
}

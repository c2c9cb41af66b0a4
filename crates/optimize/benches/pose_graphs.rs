//! Time and cost on the benchmark graphs, from the file's poses, from odometry, and from the poses of the relaxation.
//!
//! `POSECUT_SHARED_DATA=... cargo bench -p posecut-optimize --bench pose_graphs [NAME...]`

#![allow(clippy::print_stdout, reason = "a bench prints its figures")]

#[path = "../tests/g2o/best_known.rs"]
mod best_known;
#[path = "../tests/g2o/mod.rs"]
mod g2o;

use std::time::Instant;

use posecut_optimize::initialisation::spanning_tree;
use posecut_optimize::{Edge, Initialisation, Options, PoseGroup, Problem, optimize};

/// The time is the least of so many runs.
const REPEATS: usize = 30;

fn measure<G: PoseGroup<DOF>, const DOF: usize>(name: &str, best: f64, graph: (Vec<G>, Vec<Edge<G, DOF>>)) {
    let (poses, edges) = graph;
    let odometry = spanning_tree(&poses, &edges);
    // The poses of the relaxation, as a file would have them.
    let relax = Options { initialisation: Initialisation::Chordal, max_iterations: 0, ..Options::default() };
    let relaxed = Problem::new(poses.clone(), edges.clone()).map(|problem| optimize(&problem, &relax).poses);
    let starts = [
        ("file", poses.clone(), Initialisation::Best),
        ("odometry", odometry, Initialisation::Best),
        ("chordal", relaxed.unwrap_or(poses), Initialisation::Given),
    ];
    for (from, poses, initialisation) in starts {
        let problem = match Problem::new(poses, edges.clone()) {
            Ok(problem) => problem,
            Err(error) => {
                println!("{name}: {error}");
                return;
            }
        };
        let options = Options { initialisation, ..Options::default() };
        let mut milliseconds = f64::INFINITY;
        let mut solution = optimize(&problem, &options);
        for _ in 0..REPEATS {
            let start = Instant::now();
            let next = optimize(&problem, &options);
            let taken = start.elapsed().as_secs_f64() * 1e3;
            if taken < milliseconds {
                (milliseconds, solution) = (taken, next);
            }
        }
        let report = &solution.components[0];
        let phases = report.phases;
        println!(
            "{name:20} {from:9} {:8} {:3} steps ({:2} rejected, {:3} factorisations) {milliseconds:8.2} ms  cost {:.10e} gap {:8.1e} {} {:?}",
            report.start.name(),
            solution.iterations,
            report.rejected,
            report.factorizations,
            solution.chi_square,
            (solution.chi_square - best) / best,
            report.termination.name(),
            report.undetermined,
        );
        println!(
            "    analysis {:.2}, start {:.2}, linearisation {:.2}, factorisation {:.2} ({:.3} Gflop each), substitution {:.2} ms",
            1e3 * phases.analysis,
            1e3 * phases.start,
            1e3 * phases.linearisation,
            1e3 * phases.factorisation,
            1e-9 * report.flops,
            1e3 * phases.substitution,
        );
    }
}

fn main() {
    let wanted: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    for (name, best) in best_known::BEST_KNOWN.into_iter().chain([("cubicle", f64::NAN)]) {
        if !wanted.is_empty() && !wanted.iter().any(|word| word == name) {
            continue;
        }
        let Some(text) = g2o::text(name) else { continue };
        if g2o::is_planar(&text) {
            measure(name, best, g2o::planar(&text));
        } else {
            measure(name, best, g2o::spatial(&text));
        }
    }
}

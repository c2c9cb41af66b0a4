//! Time, memory and fill on generated graphs of growing size: one graph per process, so that the peak of memory is its own.
//!
//! `cargo bench -p posecut-optimize --bench growth -- manhattan|sphere POSES [SEED]` prints a line of JSON.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its figures and may panic")]

#[path = "../tests/worlds/mod.rs"]
mod worlds;

use std::time::Instant;

use posecut_geometry::{SE2, SE3};
use posecut_optimize::initialisation::spanning_tree;
use posecut_optimize::{Options, PoseGroup, Problem, optimize};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use worlds::{Graph, manhattan, sphere};

/// Optimises from odometry and prints time, memory and fill.
fn measure<G: PoseGroup<DOF>, const DOF: usize>(kind: &str, (truth, edges): Graph<G, DOF>) {
    let start = spanning_tree(&truth, &edges);
    let (poses, count) = (truth.len(), edges.len());
    let problem = Problem::new(start, edges).unwrap();
    let clock = Instant::now();
    let solution = optimize(&problem, &Options::default());
    let seconds = clock.elapsed().as_secs_f64();
    let report = &solution.components[0];
    let offset = |(pose, truth): (&G, &G)| {
        let (a, b) = (pose.translation(), truth.translation());
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>()
    };
    let error = (solution.poses.iter().zip(&truth).map(offset).sum::<f64>() / poses as f64).sqrt();
    println!(
        "{{\"kind\":\"{kind}\",\"poses\":{poses},\"edges\":{count},\"seconds\":{seconds:.4},\"iterations\":{},\
         \"factorizations\":{},\"factor_blocks\":{},\"factor_megabytes\":{:.1},\"peak_megabytes\":{:.0},\"start\":\"{}\",\
         \"chi_square_per_freedom\":{:.14},\"error_metres\":{error:.3},\"converged\":{},\
         \"analysis\":{:.2},\"starting\":{:.2},\"linearisation\":{:.2},\"factorisation\":{:.2},\"substitution\":{:.2}}}",
        solution.iterations,
        report.factorizations,
        report.factor_blocks,
        (report.factor_blocks * DOF * DOF * 8) as f64 / 1e6,
        peak_megabytes(),
        report.start.name(),
        solution.chi_square / (DOF * (count + 1 - poses)) as f64,
        solution.converged,
        report.phases.analysis,
        report.phases.start,
        report.phases.linearisation,
        report.phases.factorisation,
        report.phases.substitution,
    );
}

/// The largest resident set of this process so far; NaN if the system does not report it.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok())
        .map_or(f64::NAN, |kb| kb / 1e3)
}

fn main() {
    let words: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let (kind, poses, seed) = match words.as_slice() {
        [kind, poses] => (kind, poses, 1),
        [kind, poses, seed] => (kind, poses, seed.parse().unwrap()),
        // Without arguments, `cargo bench` runs a small graph of each kind.
        _ => {
            let mut random = ChaCha8Rng::seed_from_u64(1);
            measure::<SE2, 3>("manhattan", manhattan(1000, &mut random));
            measure::<SE3, 6>("sphere", sphere(1000, &mut random));
            return;
        }
    };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let poses = poses.parse().unwrap();
    match kind.as_str() {
        "manhattan" => measure::<SE2, 3>(kind, manhattan(poses, &mut random)),
        "sphere" => measure::<SE3, 6>(kind, sphere(poses, &mut random)),
        _ => panic!("{kind} is neither manhattan nor sphere"),
    }
}

//! Time, memory and fill on generated graphs of growing size: one graph per process, so that the peak of memory is its own.
//!
//! `cargo bench -p posecut-optimize --bench growth -- manhattan|sphere POSES [SEED]` prints a line of JSON.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its figures and may panic")]

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::time::Instant;

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, UnitQuaternion, Vector3};
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_optimize::initialisation::spanning_tree;
use posecut_optimize::{Edge, EdgeKind, Options, PoseGroup, Problem, optimize};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Standard deviation of every component of a measurement, metres and radians.
const NOISE: f64 = 0.02;

type Graph<G, const DOF: usize> = (Vec<G>, Vec<Edge<G, DOF>>);

fn measured<G: LieGroup<DOF>, const DOF: usize>(
    truth: &[G],
    from: usize,
    to: usize,
    kind: EdgeKind,
    random: &mut ChaCha8Rng,
) -> Edge<G, DOF> {
    let noise = SVector::<f64, DOF>::from_fn(|_, _| {
        let value: f64 = StandardNormal.sample(random);
        NOISE * value
    });
    let measurement = truth[from].between(&truth[to]).compose(&G::exp(&noise));
    Edge::new(from, to, measurement, SMatrix::identity() / (NOISE * NOISE), kind)
}

/// A walk along the streets of a city whose area grows with the walk. It turns at one crossing in three; half of the
/// positions that it meets again get a landmark edge to the last visit.
fn manhattan(poses: usize, random: &mut ChaCha8Rng) -> Graph<SE2, 3> {
    const BLOCK: i64 = 4;
    let side = ((poses as f64).sqrt() as i64 / BLOCK).max(2) * BLOCK;
    let (mut x, mut y, mut heading) = (0_i64, 0_i64, 0_i64);
    let mut truth = Vec::with_capacity(poses);
    let mut visits: HashMap<(i64, i64), usize> = HashMap::new();
    let mut edges = Vec::new();
    for index in 0..poses {
        truth.push(SE2::new(x as f64, y as f64, FRAC_PI_2 * heading as f64));
        if index > 0 {
            edges.push(measured(&truth, index - 1, index, EdgeKind::Odometry, random));
        }
        if let Some(before) = visits.insert((x, y), index)
            && index - before > 4
            && random.random_range(0..2) == 0
        {
            edges.push(measured(&truth, before, index, EdgeKind::Landmark, random));
        }
        let crossing = x % BLOCK == 0 && y % BLOCK == 0;
        if crossing && random.random_range(0..3) == 0 {
            heading += if random.random_range(0..2) == 0 { 1 } else { 3 };
        }
        let ahead = |heading: i64| match heading.rem_euclid(4) {
            0 => (x + 1, y),
            1 => (x, y + 1),
            2 => (x - 1, y),
            _ => (x, y - 1),
        };
        let inside = |(x, y): (i64, i64)| (0..=side).contains(&x) && (0..=side).contains(&y);
        while !inside(ahead(heading)) {
            heading += 1;
        }
        (x, y) = ahead(heading);
        heading = heading.rem_euclid(4);
    }
    (truth, edges)
}

/// A spiral over a sphere, with a landmark edge from every pose to the one a turn earlier, as in the graph sphere2500.
fn sphere(poses: usize, random: &mut ChaCha8Rng) -> Graph<SE3, 6> {
    let turn = (poses as f64).sqrt().round() as usize;
    let radius = turn as f64 / TAU;
    let pose = |index: usize| {
        let longitude = TAU * index as f64 / turn as f64;
        let latitude = std::f64::consts::PI * ((index as f64 + 0.5) / poses as f64 - 0.5);
        let out =
            Vector3::new(latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin(), latitude.sin());
        let east = Vector3::new(-longitude.sin(), longitude.cos(), 0.0);
        let axes = Matrix3::from_columns(&[east, out.cross(&east), out]);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        SE3::new(out * radius, rotation)
    };
    let truth: Vec<SE3> = (0..poses).map(pose).collect();
    let mut edges = Vec::new();
    for index in 1..poses {
        edges.push(measured(&truth, index - 1, index, EdgeKind::Odometry, random));
        if index >= turn {
            edges.push(measured(&truth, index - turn, index, EdgeKind::Landmark, random));
        }
    }
    (truth, edges)
}

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
         \"chi_square_per_freedom\":{:.4},\"error_metres\":{error:.3},\"converged\":{}}}",
        solution.iterations,
        report.factorizations,
        report.factor_blocks,
        (report.factor_blocks * DOF * DOF * 8) as f64 / 1e6,
        peak_megabytes(),
        report.start.name(),
        solution.chi_square / (DOF * (count + 1 - poses)) as f64,
        solution.converged,
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

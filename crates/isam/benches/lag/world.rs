//! A walk on a Manhattan grid, and noisy measurements on it.

use std::collections::{HashMap, VecDeque};
use std::f64::consts::FRAC_PI_2;

use nalgebra::SVector;
use posecut_geometry::{LieGroup as _, SE2};
use posecut_optimize::{Edge, EdgeKind};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Half the side of the square city, metres. At its border the walk turns back.
const CITY: i64 = 50;
/// Poses closer in time than this get no landmark edge.
const LEAST_AGE: usize = 10;
/// Standard deviations: metres along each axis, and radians.
const NOISE: [f64; 3] = [0.05, 0.05, 0.01];

/// The walk: one metre a step, a turn by a right angle at one crossing in five, crossings every five metres.
pub(crate) fn truth(seed: u64, poses: usize) -> Vec<SE2> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut x, mut y, mut quarter) = (0_i64, 0_i64, 0_usize);
    let mut walk = Vec::with_capacity(poses);
    for _ in 0..poses {
        let [dx, dy] = [[1, 0], [0, 1], [-1, 0], [0, -1]][quarter];
        walk.push(SE2::new(x as f64, y as f64, FRAC_PI_2 * quarter as f64));
        x += dx;
        y += dy;
        if (x + dx * 5).abs() > CITY || (y + dy * 5).abs() > CITY {
            quarter = (quarter + 2) % 4;
        } else if x % 5 == 0 && y % 5 == 0 {
            quarter = (quarter + [0, 0, 0, 1, 3][random.random_range(0..5)]) % 4;
        }
    }
    walk
}

/// Each pose's edges: odometry, and for a share of the returns a landmark edge to one of the earlier poses in the same place, at most
/// `reach` back.
pub(crate) fn session(seed: u64, poses: usize, reach: usize, share: f64) -> Vec<Vec<Edge<SE2, 3>>> {
    let walk = truth(seed, poses);
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x5eed);
    let mut visits: HashMap<[i64; 2], VecDeque<usize>> = HashMap::new();
    let mut arrivals = Vec::with_capacity(poses);
    for node in 0..poses {
        let mut edges = Vec::new();
        if node > 0 {
            edges.push(measure(&walk, [node - 1, node], EdgeKind::Odometry, &mut random));
        }
        let [x, y, _] = walk[node].translation();
        let earlier = visits.entry([x.round() as i64, y.round() as i64]).or_default();
        while earlier.front().is_some_and(|&other| node - other > reach) {
            earlier.pop_front();
        }
        let old: Vec<usize> = earlier.iter().copied().filter(|other| node - other >= LEAST_AGE).collect();
        if !old.is_empty() && random.random_bool(share) {
            let other = old[random.random_range(0..old.len())];
            edges.push(measure(&walk, [other, node], EdgeKind::Landmark, &mut random));
        }
        earlier.push_back(node);
        arrivals.push(edges);
    }
    arrivals
}

fn measure(walk: &[SE2], [from, to]: [usize; 2], kind: EdgeKind, random: &mut ChaCha8Rng) -> Edge<SE2, 3> {
    let noise = SVector::from(NOISE.map(|deviation| deviation * normal(random)));
    let measured = walk[from].between(&walk[to]).compose(&SE2::exp(&noise));
    Edge::new(from, to, measured, super::information(), kind)
}

/// A draw from the standard normal distribution (Box and Muller).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (radius, angle) = (1.0 - random.random::<f64>(), random.random::<f64>());
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
}

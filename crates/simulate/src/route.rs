//! The route that the robot takes, and the line that it drives.

use nalgebra::Vector2;
use petgraph::graph::NodeIndex;
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;
use serde::Serialize;

use crate::campus::{Campus, neighbours};
use crate::noise::Wander;

/// Metres between the points of a line.
pub const STEP: f64 = 0.25;
/// Corners are cut within this many metres before and after them.
const CORNER: f64 = 4.0;
/// Standard deviation of the robot's distance from the middle of a path, and its correlation length, metres.
const SIDEWAYS: f64 = 0.7;
const SIDEWAYS_LENGTH: f64 = 25.0;
/// Probability of turning round at a crossing.
const TURN_ROUND: f64 = 0.04;
/// Each time a path is driven in a direction, its weight in that direction is multiplied by this.
const NOVELTY: f64 = 0.6;

/// The route of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Route {
    /// A random walk, which revisits places in both directions
    Wander,
    /// A random walk and the same way back: the second half sees the first in the opposite direction
    Return,
}

impl Route {
    /// The line of a drive with the given length in metres.
    pub fn line(
        self,
        campus: &Campus,
        length: f64,
        route: &mut ChaCha8Rng,
        sideways: &mut ChaCha8Rng,
    ) -> Vec<Vector2<f64>> {
        let length = if self == Self::Return { 0.5 * length } else { length };
        // The line cuts corners and is therefore shorter than the walk.
        let crossings = walk(campus, length * 1.1 + 200.0, route);
        let mut points = line(campus, &crossings, length, sideways);
        if self == Self::Return {
            points.extend(way_back(&points, sideways));
        }
        points
    }
}

/// The same line from its end to its start, with new sideways deviations.
fn way_back(out: &[Vector2<f64>], draw: &mut ChaCha8Rng) -> Vec<Vector2<f64>> {
    let mut sideways = Wander::new(draw, SIDEWAYS, SIDEWAYS_LENGTH);
    let mut points = Vec::with_capacity(out.len());
    for pair in out.windows(2).rev() {
        let along = (pair[0] - pair[1]).try_normalize(1e-9).unwrap_or_else(Vector2::x);
        points.push(pair[0] + Vector2::new(-along.y, along.x) * sideways.step(draw, STEP));
    }
    smoothed(&points, (CORNER / STEP) as usize)
}

/// A random walk over crossings, of about the given length in metres. It prefers new paths but drives old ones often
/// enough that routes revisit places in both directions.
pub fn walk(campus: &Campus, length: f64, draw: &mut ChaCha8Rng) -> Vec<NodeIndex> {
    let crossings: Vec<NodeIndex> = campus.paths.node_indices().collect();
    let mut here = crossings[draw.random_range(0..crossings.len())];
    let mut route = vec![here];
    let mut driven = 0.0;
    let mut times = std::collections::HashMap::new();
    while driven < length {
        let before = route.len().checked_sub(2).map(|place| route[place]);
        let ways = neighbours(&campus.paths, here);
        let weight = |next: &NodeIndex| {
            let turn = if Some(*next) == before { TURN_ROUND } else { 1.0 };
            turn * f64::powi(NOVELTY, times.get(&(here, *next)).copied().unwrap_or(0))
        };
        let total: f64 = ways.iter().map(weight).sum();
        let mut left = draw.random_range(0.0..total);
        let next = ways.iter().copied().find(|way| {
            left -= weight(way);
            left < 0.0
        });
        let next = next.unwrap_or(ways[ways.len() - 1]);
        *times.entry((here, next)).or_insert(0) += 1;
        driven += (campus.paths[next] - campus.paths[here]).norm();
        route.push(next);
        here = next;
    }
    route
}

/// The driven line, about one point every [`STEP`] metres: the route with its corners cut, and with random deviations
/// to the left and right, so that no line is driven twice.
pub fn line(campus: &Campus, route: &[NodeIndex], length: f64, draw: &mut ChaCha8Rng) -> Vec<Vector2<f64>> {
    let mut sideways = Wander::new(draw, SIDEWAYS, SIDEWAYS_LENGTH);
    let mut points = Vec::new();
    for pair in route.windows(2) {
        let (from, to) = (campus.paths[pair[0]], campus.paths[pair[1]]);
        let along = (to - from).normalize();
        let right = Vector2::new(-along.y, along.x);
        let count = ((to - from).norm() / STEP) as usize;
        for index in 0..count {
            let offset = sideways.step(draw, STEP);
            points.push(from + along * (index as f64 * STEP) + right * offset);
        }
    }
    let mut smooth = smoothed(&points, (CORNER / STEP) as usize);
    let mut driven = 0.0;
    let end = smooth.windows(2).position(|pair| {
        driven += (pair[1] - pair[0]).norm();
        driven > length
    });
    smooth.truncate(end.map_or(smooth.len(), |end| end + 1));
    smooth
}

/// A moving mean over `reach` points on either side, then one over half as many, so that no kinks remain. O(points).
fn smoothed(points: &[Vector2<f64>], reach: usize) -> Vec<Vector2<f64>> {
    let once = moving_mean(points, reach);
    moving_mean(&once, reach / 2)
}

fn moving_mean(points: &[Vector2<f64>], reach: usize) -> Vec<Vector2<f64>> {
    let mut sums = vec![Vector2::zeros()];
    for point in points {
        sums.push(sums[sums.len() - 1] + point);
    }
    (0..points.len())
        .map(|index| {
            let reach = reach.min(index).min(points.len() - 1 - index);
            (sums[index + reach + 1] - sums[index - reach]) / (2 * reach + 1) as f64
        })
        .collect()
}

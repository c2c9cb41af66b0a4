//! The floor plan of the campus: buildings and posts beside the paths, which laser scanners see.
//!
//! It is drawn by a random stream of its own: a campus has the same paths with and without it. What is too near a path is left out.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;
use petgraph::visit::EdgeRef as _;
use posecut_random::{ChaCha8Rng, random};
use posecut_scan::Wall;
use rand::RngExt as _;

use crate::campus::Campus;

/// Side of a square of the index, metres.
const CELL: f64 = 20.0;
/// Nothing stands nearer to the middle of a path than this, metres: the robot deviates from it by some metres.
const CLEARANCE: f64 = 3.5;

/// A wall that stands upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandingWall {
    /// Its ends, x north, y east, metres.
    pub ends: Wall,
    /// Its height above the ground, metres.
    pub height: f64,
}

/// All walls, indexed by position.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// In the order in which they were drawn.
    pub walls: Vec<StandingWall>,
    cells: BTreeMap<[i64; 2], Vec<usize>>,
}

impl World {
    /// The buildings and posts of the campus with this seed. O(walls * paths).
    pub fn new(seed: u64, campus: &Campus) -> Self {
        let mut draw = random(seed, "floor plan");
        let paths: Vec<Wall> = campus
            .paths
            .edge_references()
            .map(|path| [campus.paths[path.source()], campus.paths[path.target()]])
            .collect();
        let mut world = Self::default();
        for path in &paths {
            for side in [-1.0, 1.0] {
                world.buildings(path, side, &paths, &mut draw);
                world.posts(path, side, &paths, &mut draw);
            }
        }
        world
    }

    /// A world of given walls. O(walls).
    pub fn of_walls(walls: &[StandingWall]) -> Self {
        let mut world = Self::default();
        for wall in walls {
            world.add(*wall);
        }
        world
    }

    /// The walls of which a part may be within a distance of a point, in their order. O(squares within).
    pub fn near(&self, point: &Vector2<f64>, within: f64) -> Vec<&StandingWall> {
        let mut found = BTreeSet::new();
        for x in square(point.x - within)..=square(point.x + within) {
            for y in square(point.y - within)..=square(point.y + within) {
                found.extend(self.cells.get(&[x, y]).into_iter().flatten());
            }
        }
        found.into_iter().map(|&index: &usize| &self.walls[index]).collect()
    }

    fn add(&mut self, wall: StandingWall) {
        let [low, high] = [wall.ends[0].inf(&wall.ends[1]), wall.ends[0].sup(&wall.ends[1])];
        for x in square(low.x)..=square(high.x) {
            for y in square(low.y)..=square(high.y) {
                self.cells.entry([x, y]).or_default().push(self.walls.len());
            }
        }
        self.walls.push(wall);
    }

    /// Fronts of buildings with pilasters, along one side of a path.
    fn buildings(&mut self, path: &Wall, side: f64, paths: &[Wall], draw: &mut ChaCha8Rng) {
        let frame = Frame::beside(path, side);
        let mut along = draw.random_range(2.0..8.0);
        while along < frame.length - 10.0 {
            let [length, depth] = [draw.random_range(7.0..20.0), draw.random_range(5.0..12.0)];
            let offset = draw.random_range(5.0..11.0);
            let height = draw.random_range(3.0..15.0);
            self.rectangle(&frame, [along, along + length], [offset, offset + depth], height, paths);
            let mut at = along + draw.random_range(0.5..3.0);
            while at < along + length - 2.0 {
                let [width, depth] = [draw.random_range(0.4..1.8), draw.random_range(0.2..0.9)];
                let height = height.min(draw.random_range(2.0..15.0));
                self.rectangle(&frame, [at, at + width], [offset - depth, offset], height, paths);
                at += width + draw.random_range(1.5..6.0);
            }
            along += length + draw.random_range(2.0..10.0);
        }
    }

    /// Posts and trunks beside a path.
    fn posts(&mut self, path: &Wall, side: f64, paths: &[Wall], draw: &mut ChaCha8Rng) {
        let frame = Frame::beside(path, side);
        let mut along = draw.random_range(0.0..8.0);
        while along < frame.length {
            let width = draw.random_range(0.15..0.5);
            let offset = draw.random_range(CLEARANCE..5.0);
            let height = draw.random_range(1.0..6.0);
            self.rectangle(&frame, [along, along + width], [offset, offset + width], height, paths);
            along += draw.random_range(4.0..14.0);
        }
    }

    /// Four walls, unless they are too near a path.
    fn rectangle(&mut self, frame: &Frame, along: [f64; 2], aside: [f64; 2], height: f64, paths: &[Wall]) {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
            .map(|[one, other]: [usize; 2]| frame.at(along[one], aside[other]));
        let walls: Vec<Wall> = (0..4).map(|corner| [corners[corner], corners[(corner + 1) % 4]]).collect();
        if walls.iter().all(|wall| paths.iter().all(|path| distance(wall, path) >= CLEARANCE)) {
            for ends in walls {
                self.add(StandingWall { ends, height });
            }
        }
    }
}

/// Positions by the way along a path and the distance from it.
struct Frame {
    start: Vector2<f64>,
    along: Vector2<f64>,
    aside: Vector2<f64>,
    length: f64,
}

impl Frame {
    fn beside([start, end]: &Wall, side: f64) -> Self {
        let way = end - start;
        let along = way.try_normalize(1e-9).unwrap_or_else(Vector2::x);
        Self { start: *start, along, aside: Vector2::new(-along.y, along.x) * side, length: way.norm() }
    }

    fn at(&self, along: f64, aside: f64) -> Vector2<f64> {
        self.start + self.along * along + self.aside * aside
    }
}

/// The row or column of the index that a coordinate is in, metres.
fn square(coordinate: f64) -> i64 {
    (coordinate / CELL).floor() as i64
}

/// The distance between two segments, metres.
fn distance(one: &Wall, other: &Wall) -> f64 {
    let way = one[1] - one[0];
    if let Some(share) = posecut_scan::distance_to_wall(other, &one[0], &way)
        && share <= 1.0
    {
        return 0.0;
    }
    let to_segment = |point: &Vector2<f64>, [start, end]: &Wall| {
        let way = end - start;
        let share = (way.dot(&(point - start)) / way.norm_squared().max(1e-18)).clamp(0.0, 1.0);
        (start + way * share - point).norm()
    };
    let ends = one.iter().map(|point| to_segment(point, other));
    ends.chain(other.iter().map(|point| to_segment(point, one))).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_clear_and_have_something_to_see() {
        let campus = Campus::new(1);
        let world = World::new(1, &campus);
        for path in campus.paths.edge_references() {
            let path = [campus.paths[path.source()], campus.paths[path.target()]];
            let middle = (path[0] + path[1]) * 0.5;
            let near = world.near(&middle, 25.0);
            assert!(near.len() > 20, "{} walls", near.len());
            assert!(near.iter().all(|wall| distance(&wall.ends, &path) >= CLEARANCE));
        }
    }
}

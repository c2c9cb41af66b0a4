//! Correlative matching by branch and bound (Hess et al., *Real-time loop closure in 2D LIDAR SLAM*, ICRA 2016, algorithm 3).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector2;
use posecut_geometry::SE2;

use crate::Cloud;
use crate::field::{Field, LEVELS};

/// The poses among which a match is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The middle of the window.
    pub middle: SE2,
    /// The largest distance from the middle along each axis, metres.
    pub distance: f64,
    /// The largest difference of the heading, radians.
    pub angle: f64,
}

/// The best pose of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The pose of the query in the frame of the reference, on the grid of poses.
    pub pose: SE2,
    /// Its score: the mean over the query's points of the field's value, 0 to 1.
    pub score: f64,
}

/// A square of translations at one heading.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Square {
    /// The sum over points of an upper bound.
    bound: u32,
    level: usize,
    heading: usize,
    /// The lower left translation, cells.
    column: i32,
    row: i32,
}

impl Ord for Square {
    /// The largest bound first; of equal ones the finest level, then the first in the order of the grid.
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |square: &Self| {
            (std::cmp::Reverse(square.level), std::cmp::Reverse((square.heading, square.column, square.row)))
        };
        self.bound.cmp(&other.bound).then_with(|| key(self).cmp(&key(other)))
    }
}

impl PartialOrd for Square {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Field {
    /// The best pose of several windows on the grid of poses: translations by the cells of the field, headings by `angle_step`. `None` if no
    /// pose has a score of at least `least`. The result is that of an exhaustive search; of equal scores the first in the order of
    /// the grid wins.
    pub fn search(&self, query: &Cloud, windows: &[Window], angle_step: f64, least: f64) -> Option<Found> {
        let count = query.len();
        let needed = (least * 255.0 * count as f64).ceil() as u32;
        let mut turned: Vec<Vec<(i32, i32)>> = Vec::new();
        let mut poses: Vec<(SE2, f64)> = Vec::new();
        let mut open = BinaryHeap::new();
        for window in windows {
            let steps = (window.angle / angle_step).floor() as i32;
            let reach = (window.distance / self.resolution).floor() as i32;
            for step in -steps..=steps {
                let heading = window.middle.angle() + f64::from(step) * angle_step;
                let turn = SE2::new(window.middle.translation.x, window.middle.translation.y, heading);
                let cells =
                    query.points.iter().map(|point| self.cell(&(turn.translation + turn.rotation * point)));
                turned.push(cells.collect());
                poses.push((turn, heading));
                self.open_heading(&turned, reach, needed, &mut open);
            }
        }
        while let Some(square) = open.pop() {
            if square.level == 0 {
                let (turn, heading) = &poses[square.heading];
                let moved = Vector2::new(f64::from(square.column), f64::from(square.row)) * self.resolution;
                let position = turn.translation + moved;
                let score = f64::from(square.bound) / (255.0 * count as f64);
                return Some(Found { pose: SE2::new(position.x, position.y, *heading), score });
            }
            let level = square.level - 1;
            let half = 1 << level;
            for (column, row) in [(0, 0), (half, 0), (0, half), (half, half)] {
                let (column, row) = (square.column + column, square.row + row);
                let bound = self.bound(&turned[square.heading], level, column, row);
                if bound >= needed.max(1) {
                    open.push(Square { bound, level, heading: square.heading, column, row });
                }
            }
        }
        None
    }

    /// Opens the coarse squares of the newest heading: they cover the translations up to `reach` cells along each axis.
    fn open_heading(
        &self,
        turned: &[Vec<(i32, i32)>],
        reach: i32,
        needed: u32,
        open: &mut BinaryHeap<Square>,
    ) {
        let Some(cells) = turned.last() else { return };
        let level = (0..LEVELS).rev().find(|level| 1 << level <= 2 * reach + 1).unwrap_or(0);
        let side = 1_usize << level;
        for column in (-reach..=reach).step_by(side) {
            for row in (-reach..=reach).step_by(side) {
                let bound = self.bound(cells, level, column, row);
                if bound >= needed.max(1) {
                    open.push(Square { bound, level, heading: turned.len() - 1, column, row });
                }
            }
        }
    }

    /// An upper bound of the sum over points for all translations of a square.
    fn bound(&self, cells: &[(i32, i32)], level: usize, column: i32, row: i32) -> u32 {
        cells.iter().map(|(x, y)| u32::from(self.value(level, x + column, y + row))).sum()
    }
}

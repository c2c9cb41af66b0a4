//! The grid and its updates.

use nalgebra::Vector2;
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{Dimension, PoseGraph};
use posecut_scan::{LaserScan, Scans};

use crate::MapError;
use crate::rays::cells_between;

/// What a beam adds to the log-odds of the cell in which it ends, and of those it passes: probabilities 0.7 and 0.4. These, and the
/// bounds, are those of OctoMap (Hornung et al., Autonomous Robots 34, 2013, section 3.4).
const HIT: f32 = 0.85;
const MISS: f32 = -0.4;
/// The bounds of the log-odds: probabilities 0.12 and 0.97. They let a cell change its mind when the world changed.
const BOUNDS: [f32; 2] = [-2.0, 3.5];

/// A cell is occupied above this, and free below its negative: a single passing beam makes it free.
const DECIDED: f32 = 0.3;

/// The largest grid.
const MOST_CELLS: usize = 200_000_000;

/// Empty space around everything seen, metres.
const MARGIN: f64 = 0.5;

/// What a grid knows about a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    /// No beam has entered it, or as many ended in it as passed.
    Unknown,
    /// Beams pass.
    Free,
    /// Beams end.
    Occupied,
}

/// Log-odds of occupancy.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Side of a cell, metres.
    pub resolution: f64,
    /// Corner of the first cell, metres.
    pub corner: Vector2<f64>,
    /// Cells along x.
    pub width: usize,
    /// Cells along y.
    pub height: usize,
    log_odds: Vec<f32>,
}

impl Grid {
    /// The grid of a graph's scans from its poses. Beams beyond `max_range` are not used. O(cells + beams * range / resolution).
    pub fn of_graph(
        graph: &PoseGraph,
        scans: &Scans,
        resolution: f64,
        max_range: f64,
    ) -> Result<Self, MapError> {
        if graph.header.dimension != Dimension::Two {
            return Err(MapError::Spatial);
        }
        let placed = scans
            .iter()
            .map(|(node, scan)| {
                let index = graph.node_index(node).ok_or(MapError::NoPose(node))?;
                let pose = graph.nodes[index].pose.as_deref().and_then(SE2::from_components);
                Ok((pose.ok_or(MapError::NoPose(node))?, scan))
            })
            .collect::<Result<Vec<(SE2, &LaserScan)>, MapError>>()?;
        if placed.is_empty() {
            return Err(MapError::NoScans);
        }
        let mut grid = Self::around(&placed, resolution, max_range)?;
        let mut seen =
            Seen { scan: 0, passed: vec![0; grid.log_odds.len()], ended: vec![0; grid.log_odds.len()] };
        for (pose, scan) in &placed {
            grid.add(pose, scan, max_range, &mut seen);
        }
        Ok(grid)
    }

    /// An empty grid that has room for the poses and all end points.
    fn around(placed: &[(SE2, &LaserScan)], resolution: f64, max_range: f64) -> Result<Self, MapError> {
        let mut low = placed[0].0.translation;
        let mut high = low;
        for (pose, scan) in placed {
            let ends = ends(scan, max_range).map(|point| pose.translation + pose.rotation * point);
            for point in ends.chain([pose.compose(&scan.sensor).translation, pose.translation]) {
                low = low.inf(&point);
                high = high.sup(&point);
            }
        }
        // Corners are multiples of a cell, so that the same points fall into the same cells in every map.
        let corner = ((low.add_scalar(-MARGIN)) / resolution).map(f64::floor) * resolution;
        let extent = high.add_scalar(MARGIN) - corner;
        let cells = (extent / resolution).map(|count| count.ceil().max(1.0));
        if !(cells.x * cells.y <= MOST_CELLS as f64) {
            let (width, height) = (extent.x, extent.y);
            return Err(MapError::TooLarge { width, height, resolution, most: MOST_CELLS });
        }
        let (width, height) = (cells.x as usize, cells.y as usize);
        Ok(Self { resolution, corner, width, height, log_odds: vec![0.0; width * height] })
    }

    /// Updates each cell at most once for a scan: that a beam ends in it counts more than that others pass.
    fn add(&mut self, pose: &SE2, scan: &LaserScan, max_range: f64, seen: &mut Seen) {
        seen.scan += 1;
        let start = self.in_cells(&pose.compose(&scan.sensor).translation);
        let ends: Vec<Vector2<f64>> = ends(scan, max_range)
            .map(|point| self.in_cells(&(pose.translation + pose.rotation * point)))
            .collect();
        for end in &ends {
            if let Some(cell) = self.index([end.x.floor() as i64, end.y.floor() as i64])
                && std::mem::replace(&mut seen.ended[cell], seen.scan) != seen.scan
            {
                self.update(cell, HIT);
            }
        }
        for end in &ends {
            cells_between(start, *end, |cell| {
                if let Some(cell) = self.index(cell)
                    && seen.ended[cell] != seen.scan
                    && std::mem::replace(&mut seen.passed[cell], seen.scan) != seen.scan
                {
                    self.update(cell, MISS);
                }
            });
        }
    }

    fn update(&mut self, cell: usize, change: f32) {
        self.log_odds[cell] = (self.log_odds[cell] + change).clamp(BOUNDS[0], BOUNDS[1]);
    }

    /// A point in units of cells from the corner.
    pub(crate) fn in_cells(&self, point: &Vector2<f64>) -> Vector2<f64> {
        (point - self.corner) / self.resolution
    }

    fn index(&self, [column, row]: [i64; 2]) -> Option<usize> {
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        (column < self.width && row < self.height).then_some(row * self.width + column)
    }

    /// The probability that a cell is occupied. Column and row count from the corner.
    ///
    /// # Panics
    /// Outside the grid.
    pub fn probability(&self, column: usize, row: usize) -> f64 {
        1.0 / (1.0 + f64::from(-self.log_odds[row * self.width + column]).exp())
    }

    /// What is known about a cell.
    ///
    /// # Panics
    /// Outside the grid.
    pub fn cell(&self, column: usize, row: usize) -> Cell {
        match self.log_odds[row * self.width + column] {
            odds if odds > DECIDED => Cell::Occupied,
            odds if odds < -DECIDED => Cell::Free,
            _ => Cell::Unknown,
        }
    }

    /// The number of cells of a kind. O(cells).
    pub fn count(&self, kind: Cell) -> usize {
        let cells = (0..self.height).flat_map(|row| (0..self.width).map(move |column| (column, row)));
        cells.filter(|&(column, row)| self.cell(column, row) == kind).count()
    }
}

/// For each cell the number of the last scan of which a beam passed, and ended in it.
struct Seen {
    scan: u32,
    passed: Vec<u32>,
    ended: Vec<u32>,
}

/// The end points of the beams with a return up to a range, in the frame of the robot.
fn ends(scan: &LaserScan, max_range: f64) -> impl Iterator<Item = Vector2<f64>> + '_ {
    scan.numbered_points().filter(move |(beam, _)| scan.ranges[*beam] <= max_range).map(|(_, point)| point)
}

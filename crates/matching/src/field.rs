//! Likelihood fields and their pyramids of maxima.

use nalgebra::Vector2;

use crate::Cloud;

/// For each cell of a grid, how likely a point of a wall is there: 1 at a point of the reference, falling off as a Gaussian with
/// the distance. Coarser levels hold the maximum over squares of cells, so that they bound every pose in a window from above
/// (Olson, *Real-time correlative scan matching*, ICRA 2009; Hess et al., *Real-time loop closure in 2D LIDAR SLAM*, ICRA 2016,
/// equation 16).
#[derive(Clone, Debug)]
pub struct Field {
    /// Side of a cell, metres.
    pub(crate) resolution: f64,
    /// The lower corner of the grid, metres.
    pub(crate) corner: Vector2<f64>,
    columns: usize,
    rows: usize,
    /// `levels[h]` at a cell is the maximum over `2^h` cells to the right and upwards, 0 to 255.
    levels: Vec<Vec<u8>>,
}

/// The largest number of cells: 64 MB for seven levels.
const MOST_CELLS: usize = 8 << 20;

/// Levels of the pyramid: the coarsest squares have 2^6 cells a side.
pub(crate) const LEVELS: usize = 7;

impl Field {
    /// The field of a reference, with this resolution and standard deviation, metres. A coarser resolution is used where the points
    /// lie so far apart that the grid would have more than eight million cells. O(points + cells).
    pub fn new(reference: &Cloud, resolution: f64, deviation: f64) -> Self {
        // The lowest point lies within a cell, not on its border, where the last bit of a pose would move it.
        let margin = 3.0 * deviation + 1.4 * resolution;
        let (mut low, mut high) = (Vector2::repeat(0.0), Vector2::repeat(0.0));
        if let Some(first) = reference.points.first() {
            (low, high) = (*first, *first);
        }
        for point in &reference.points {
            low = low.inf(point);
            high = high.sup(point);
        }
        let (corner, extent) = (low - Vector2::repeat(margin), high - low + Vector2::repeat(2.0 * margin));
        let resolution = resolution
            .max((extent.x * extent.y / MOST_CELLS as f64).sqrt())
            .max(extent.max() / MOST_CELLS as f64);
        let columns = (extent.x / resolution).ceil() as usize + 1;
        let rows = (extent.y / resolution).ceil() as usize + 1;
        let mut field = Self { resolution, corner, columns, rows, levels: vec![vec![0; columns * rows]] };
        for point in &reference.points {
            field.add(point, deviation);
        }
        for level in 1..LEVELS {
            field.levels.push(field.coarser(level));
        }
        field
    }

    /// The value at a cell of a level, 0 outside the grid. A cell's coordinates may be negative: a coarse square may reach into
    /// the grid.
    #[inline]
    pub(crate) fn value(&self, level: usize, column: i32, row: i32) -> u8 {
        // A coarse square that begins left of or below the grid is bounded by the one at the edge, which covers what it covers inside.
        let span = (1 << level) - 1;
        let inside = |at: i32, count: usize| {
            (at >= -span && i64::from(at) < count as i64).then_some(at.max(0) as usize)
        };
        match (inside(column, self.columns), inside(row, self.rows)) {
            (Some(column), Some(row)) => self.levels[level][row * self.columns + column],
            _ => 0,
        }
    }

    /// The cell of a point.
    #[inline]
    pub(crate) fn cell(&self, point: &Vector2<f64>) -> (i32, i32) {
        let at = (point - self.corner) / self.resolution;
        (at.x.floor() as i32, at.y.floor() as i32)
    }

    /// The bell around one point, where it is higher than what is there.
    fn add(&mut self, point: &Vector2<f64>, deviation: f64) {
        let reach = (3.0 * deviation / self.resolution).ceil() as i32;
        let (column, row) = self.cell(point);
        for row in (row - reach).max(0)..=(row + reach).min(self.rows as i32 - 1) {
            for column in (column - reach).max(0)..=(column + reach).min(self.columns as i32 - 1) {
                let middle = Vector2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
                let squared = (self.corner + middle * self.resolution - point).norm_squared();
                let value = (255.0 * (-0.5 * squared / (deviation * deviation)).exp()).round() as u8;
                let cell = &mut self.levels[0][row as usize * self.columns + column as usize];
                *cell = value.max(*cell);
            }
        }
    }

    /// A level from the one below it: the maximum of four squares that make the larger one.
    fn coarser(&self, level: usize) -> Vec<u8> {
        let below = &self.levels[level - 1];
        let step = 1 << (level - 1);
        let mut maxima = below.clone();
        for row in 0..self.rows {
            let upper = (row + step).min(self.rows - 1);
            for column in 0..self.columns {
                let right = (column + step).min(self.columns - 1);
                maxima[row * self.columns + column] = below[row * self.columns + column]
                    .max(below[row * self.columns + right])
                    .max(below[upper * self.columns + column])
                    .max(below[upper * self.columns + right]);
            }
        }
        maxima
    }
}

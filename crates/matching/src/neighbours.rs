//! Nearest points, by a grid.

use nalgebra::Vector2;

/// Finds the nearest of many points within a radius. The grid's squares have the side of the radius, so a query looks at nine.
#[derive(Clone, Debug)]
pub struct Neighbours {
    /// The lower corner of the grid, metres.
    corner: Vector2<f64>,
    side: f64,
    columns: usize,
    rows: usize,
    /// For each square the position of its first point in `order`; one more at the end.
    starts: Vec<u32>,
    /// The points, by squares.
    order: Vec<(u32, Vector2<f64>)>,
}

/// Squares that the grid may have for each point, so that few points far apart cannot ask for much memory.
const SQUARES_A_POINT: f64 = 64.0;

impl Neighbours {
    /// An index over points for queries up to a radius, metres. O(points).
    pub fn new(points: &[Vector2<f64>], radius: f64) -> Self {
        let (mut low, mut high) = (Vector2::repeat(0.0), Vector2::repeat(0.0));
        if let Some(first) = points.first() {
            (low, high) = (*first, *first);
        }
        for point in points {
            low = low.inf(point);
            high = high.sup(point);
        }
        let extent = high - low;
        let most = SQUARES_A_POINT * points.len().max(16) as f64;
        let side = radius.max((extent.x * extent.y / most).sqrt()).max(extent.max() / most);
        let columns = (extent.x / side).floor() as usize + 1;
        let rows = (extent.y / side).floor() as usize + 1;
        let square = |point: &Vector2<f64>| {
            let at = (point - low) / side;
            (at.y.floor() as usize).min(rows - 1) * columns + (at.x.floor() as usize).min(columns - 1)
        };
        let mut starts = vec![0; columns * rows + 1];
        for point in points {
            starts[square(point) + 1] += 1;
        }
        for index in 1..starts.len() {
            starts[index] += starts[index - 1];
        }
        let mut next = starts.clone();
        let mut order = vec![(0, Vector2::zeros()); points.len()];
        for (index, point) in points.iter().enumerate() {
            let at = &mut next[square(point)];
            order[*at as usize] = (index as u32, *point);
            *at += 1;
        }
        Self { corner: low, side, columns, rows, starts, order }
    }

    /// The index of the nearest accepted point within a distance (at most the radius of the index), and the squared distance. Ties go to
    /// the lower index. Expected O(points of nine squares).
    pub fn nearest(
        &self,
        query: &Vector2<f64>,
        within: f64,
        accepted: impl Fn(usize) -> bool,
    ) -> Option<(usize, f64)> {
        let at = (query - self.corner) / self.side;
        let span = |value: f64, count: usize| {
            let low = (value.floor() - 1.0).max(0.0);
            let high = (value.floor() + 1.0).min(count as f64 - 1.0);
            (low <= high).then_some((low as usize, high as usize))
        };
        let (first_column, last_column) = span(at.x, self.columns)?;
        let (first_row, last_row) = span(at.y, self.rows)?;
        let mut best: Option<(usize, f64)> = None;
        let limit = within * within;
        for row in first_row..=last_row {
            let start = self.starts[row * self.columns + first_column] as usize;
            let end = self.starts[row * self.columns + last_column + 1] as usize;
            for (index, point) in &self.order[start..end] {
                let squared = (point - query).norm_squared();
                let index = *index as usize;
                let better =
                    best.is_none_or(|(found, least)| squared < least || (squared == least && index < found));
                if squared <= limit && better && accepted(index) {
                    best = Some((index, squared));
                }
            }
        }
        best
    }
}

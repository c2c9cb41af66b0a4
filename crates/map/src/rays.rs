//! The cells on a ray.

use nalgebra::Vector2;

/// Calls `visit` for each cell that the segment from `start` to `end` enters, in order, the last one included. Coordinates are in cells.
/// O(cells) (Amanatides, Woo, *A fast voxel traversal algorithm for ray tracing*, Eurographics 1987).
pub(crate) fn cells_between(start: Vector2<f64>, end: Vector2<f64>, mut visit: impl FnMut([i64; 2])) {
    let mut cell = [start.x.floor() as i64, start.y.floor() as i64];
    let last = [end.x.floor() as i64, end.y.floor() as i64];
    let along = end - start;
    let axis = |at: usize| {
        let (direction, from) = (along[at], start[at]);
        let step: i64 = if direction > 0.0 { 1 } else { -1 };
        // The share of the segment until the next border, and from border to border.
        let border = if direction > 0.0 { from.floor() + 1.0 - from } else { from - from.floor() };
        let size = direction.abs();
        if size > 0.0 { (step, border / size, 1.0 / size) } else { (step, f64::INFINITY, f64::INFINITY) }
    };
    let [mut x, mut y] = [axis(0), axis(1)];
    // As many steps as there are borders between the cells, whatever the rounding says.
    let steps = (last[0] - cell[0]).abs() + (last[1] - cell[1]).abs();
    visit(cell);
    for _ in 0..steps {
        let first = cell[0] != last[0] && (x.1 < y.1 || cell[1] == last[1]);
        let (at, axis) = if first { (0, &mut x) } else { (1, &mut y) };
        cell[at] += axis.0;
        axis.1 += axis.2;
        visit(cell);
    }
}

//! Walls, for scans that are simulated.

use nalgebra::Vector2;

/// A wall from one point to another, metres.
pub type Wall = [Vector2<f64>; 2];

/// The distance along a ray at which it meets a wall, in lengths of the direction `along`; `None` if it does not. O(1).
pub fn distance_to_wall([start, end]: &Wall, origin: &Vector2<f64>, along: &Vector2<f64>) -> Option<f64> {
    let wall = end - start;
    let determinant = along.perp(&wall);
    let offset = start - origin;
    let (distance, share) = (offset.perp(&wall) / determinant, offset.perp(along) / determinant);
    (distance > 0.0 && (0.0..=1.0).contains(&share)).then_some(distance)
}

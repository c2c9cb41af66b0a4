//! Pairs of viewpoints that truly see the same place.

use std::collections::HashMap;

use posecut_geometry::wrap_angle;

use crate::Options;
use crate::landmark::Viewpoint;

/// Pairs of viewpoints of different experiences within the radius and the heading, in ascending order.
/// A grid of cells as wide as the radius makes it O(viewpoints + pairs).
pub(crate) fn similar_pairs(viewpoints: &[Viewpoint], options: &Options) -> Vec<(usize, usize)> {
    let cell_of = |viewpoint: &Viewpoint| {
        let cell = |coordinate: f64| (coordinate / options.radius).floor() as i64;
        (cell(viewpoint.position[0]), cell(viewpoint.position[1]))
    };
    let mut cells: HashMap<(i64, i64), Vec<usize>> = HashMap::new();
    for (index, viewpoint) in viewpoints.iter().enumerate() {
        cells.entry(cell_of(viewpoint)).or_default().push(index);
    }
    let mut pairs = Vec::new();
    for (first, viewpoint) in viewpoints.iter().enumerate() {
        let (x, y) = cell_of(viewpoint);
        for near in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy))) {
            let Some(members) = cells.get(&near) else { continue };
            let similar = members.iter().filter(|&&second| similar(viewpoint, &viewpoints[second], options));
            pairs.extend(similar.map(|&second| (first, second)));
        }
    }
    pairs.sort_unstable();
    pairs
}

fn similar(first: &Viewpoint, second: &Viewpoint, options: &Options) -> bool {
    let apart_in_time = match (first.utime, second.utime) {
        (Some(first), Some(second)) => first.abs_diff(second) as f64 * 1e-6 >= options.minimum_interval,
        _ => true,
    };
    first.experience < second.experience
        && apart_in_time
        && first.distance(second) <= options.radius
        && wrap_angle(first.heading - second.heading).abs() <= options.heading.to_radians()
}

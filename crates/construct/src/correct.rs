//! Finds pairs of viewpoints that truly see the same place.

use std::collections::HashMap;
use std::f64::consts::PI;

use posecut_geometry::wrap_angle;

use crate::Options;
use crate::viewpoint::Viewpoint;

/// The condition for two viewpoints to see the same place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Similarity {
    /// Largest distance, metres.
    pub(crate) radius: f64,
    /// Largest difference of heading, radians.
    pub(crate) heading: f64,
    /// Least time between them, seconds.
    pub(crate) minimum_interval: f64,
    /// Where the second viewpoint is expected, relative to the first, metres. It is zero except for kinds of mistakes
    /// that displace places.
    pub(crate) displacement: [f64; 3],
    /// Whether viewpoints with opposite headings see the same place too.
    pub(crate) opposite: bool,
}

impl Similarity {
    pub(crate) fn of(options: &Options) -> Self {
        Self {
            radius: options.radius,
            heading: options.heading.to_radians(),
            minimum_interval: options.minimum_interval,
            displacement: [0.0; 3],
            opposite: options.opposite_direction,
        }
    }

    /// Whether the second viewpoint is in a later experience and near its expected position.
    pub(crate) fn holds<G>(&self, first: &Viewpoint<G>, second: &Viewpoint<G>) -> bool {
        let apart_in_time = match (first.utime, second.utime) {
            (Some(first), Some(second)) => first.abs_diff(second) as f64 * 1e-6 >= self.minimum_interval,
            _ => true,
        };
        first.experience < second.experience && apart_in_time && self.near(first, second)
    }

    /// Whether the second viewpoint is near its expected position, in any experience.
    pub(crate) fn near<G>(&self, first: &Viewpoint<G>, second: &Viewpoint<G>) -> bool {
        second.distance_to(self.sought(first)) <= self.radius && self.alike(first.heading - second.heading)
    }

    /// Whether headings with this difference count as the same.
    fn alike(&self, difference: f64) -> bool {
        let within = |angle: f64| wrap_angle(angle).abs() <= self.heading;
        within(difference) || (self.opposite && within(difference - PI))
    }

    fn sought<G>(&self, first: &Viewpoint<G>) -> [f64; 3] {
        std::array::from_fn(|axis| first.position[axis] + self.displacement[axis])
    }

    /// All pairs that satisfy the condition, in ascending order. A grid of cells as wide as the radius makes this
    /// O(viewpoints + pairs).
    pub(crate) fn pairs<G>(&self, viewpoints: &[Viewpoint<G>]) -> Vec<(usize, usize)> {
        let cell_of = |position: [f64; 3]| {
            let cell = |coordinate: f64| (coordinate / self.radius).floor() as i64;
            (cell(position[0]), cell(position[1]))
        };
        let mut cells: HashMap<(i64, i64), Vec<usize>> = HashMap::new();
        for (index, viewpoint) in viewpoints.iter().enumerate() {
            cells.entry(cell_of(viewpoint.position)).or_default().push(index);
        }
        let mut pairs = Vec::new();
        for (first, viewpoint) in viewpoints.iter().enumerate() {
            let (x, y) = cell_of(self.sought(viewpoint));
            for near in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy))) {
                let Some(members) = cells.get(&near) else { continue };
                let similar = members.iter().filter(|&&second| self.holds(viewpoint, &viewpoints[second]));
                pairs.extend(similar.map(|&second| (first, second)));
            }
        }
        pairs.sort_unstable();
        pairs
    }
}

//! Points with normals: a scan, or a local map made of several.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use posecut_geometry::SE2;
use posecut_scan::LaserScan;

use crate::segments::surfels;

/// By what part of a cell the borders of cells are moved where scanners report whole units: the golden section of one, which no simple
/// fraction comes near.
pub const OFF_GRID: f64 = 0.381_966_011_250_105;

/// Points of walls in one frame, with the normals of the walls.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// The points, metres.
    pub points: Vec<Vector2<f64>>,
    /// For each point the unit normal of its wall, towards the scanner; `None` if the point lies on no line.
    pub normals: Vec<Option<Vector2<f64>>>,
    /// For each point the position of the scanner that saw it.
    pub origins: Vec<Vector2<f64>>,
}

impl Cloud {
    /// The cloud of a scan, in the frame of the robot. O(beams).
    pub fn of_scan(scan: &LaserScan) -> Self {
        let mut cloud = Self::default();
        for surfel in surfels(scan) {
            cloud.points.push(surfel.point);
            cloud.normals.push(surfel.normal);
            cloud.origins.push(scan.sensor.translation);
        }
        cloud
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Adds the points of another cloud whose frame has this pose.
    pub fn add(&mut self, other: &Self, pose: &SE2) {
        self.points.extend(other.points.iter().map(|point| pose.translation + pose.rotation * point));
        self.normals.extend(other.normals.iter().map(|normal| normal.map(|normal| pose.rotation * normal)));
        self.origins.extend(other.origins.iter().map(|origin| pose.translation + pose.rotation * origin));
    }

    /// One point for each square of this side: the one seen from nearest, which is the most exact, and of several seen from the same
    /// distance the first. Points of walls that face different ways (the two sides of a door) stay apart. The order is that of the
    /// squares. O(n log n).
    ///
    /// Scanners report ranges in whole centimetres or millimetres. So that the choice does not hang on the last bit of a pose, the squares'
    /// borders lie off such numbers by [`OFF_GRID`], and ranges are compared in whole millimetres.
    #[must_use]
    pub fn thinned(&self, side: f64) -> Self {
        let mut kept: BTreeMap<(i64, i64, u8), usize> = BTreeMap::new();
        for index in 0..self.len() {
            let square = |value: f64| (value / side + OFF_GRID).floor() as i64;
            let key =
                (square(self.points[index].x), square(self.points[index].y), facing(self.normals[index]));
            kept.entry(key)
                .and_modify(|best| {
                    if self.millimetres(index) < self.millimetres(*best) {
                        *best = index;
                    }
                })
                .or_insert(index);
        }
        self.selected(kept.into_values())
    }

    /// At most this many points, taken at equal distances in their order.
    #[must_use]
    pub fn at_most(&self, most: usize) -> Self {
        let step = (self.len() as f64 / most.max(1) as f64).max(1.0);
        let count = (self.len() as f64 / step).floor() as usize;
        self.selected((0..count).map(|number| (number as f64 * step) as usize))
    }

    /// The distance at which a point was seen.
    fn millimetres(&self, index: usize) -> i64 {
        ((self.points[index] - self.origins[index]).norm() * 1000.0).round() as i64
    }

    fn selected(&self, indices: impl Iterator<Item = usize>) -> Self {
        let mut chosen = Self::default();
        for index in indices {
            chosen.points.push(self.points[index]);
            chosen.normals.push(self.normals[index]);
            chosen.origins.push(self.origins[index]);
        }
        chosen
    }
}

/// The quarter of the circle into which a normal points, or a fifth class for none.
fn facing(normal: Option<Vector2<f64>>) -> u8 {
    match normal {
        None => 4,
        Some(normal) if normal.x.abs() >= normal.y.abs() => u8::from(normal.x < 0.0),
        Some(normal) => 2 + u8::from(normal.y < 0.0),
    }
}

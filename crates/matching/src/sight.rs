//! Whether a scan could have been taken in a map: which of the map's walls it sees, and through which it looks.

use std::f64::consts::TAU;

use posecut_geometry::{LieGroup, SE2};
use posecut_scan::LaserScan;

use crate::Cloud;

/// What a scan says about the walls of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sight {
    /// Points of the map where the scan has a return.
    pub seen: usize,
    /// Points of the map that the scan should see, and looks through.
    pub through: usize,
}

impl Sight {
    /// The share of the points in sight that the scan confirms; 0 if none are in sight.
    pub fn share(&self) -> f64 {
        if self.seen == 0 { 0.0 } else { self.seen as f64 / (self.seen + self.through) as f64 }
    }

    /// Both counts of two.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { seen: self.seen + other.seen, through: self.through + other.through }
    }
}

/// A wall that the beam meets at a smaller angle than this, sine, is no evidence: a small error moves where the beam ends by metres.
const GRAZING: f64 = 0.3;

/// Compares a scan taken by a robot at a pose in the frame of a map with the points of the map that face it, up to a range and with a
/// tolerance along the beam, metres. Points behind the end of a beam are hidden and count for nothing. O(points).
pub fn sight(map: &Cloud, scan: &LaserScan, pose: &SE2, range: f64, tolerance: f64) -> Sight {
    let inverse = pose.compose(&scan.sensor).inverse();
    let mut sight = Sight::default();
    for (point, normal) in map.points.iter().zip(&map.normals) {
        let here = inverse.translation + inverse.rotation * point;
        let distance = here.norm();
        let Some(normal) = normal.map(|normal| inverse.rotation * normal) else { continue };
        // The wall must face the scanner: the normal points to where it was seen from.
        if distance > range || -normal.dot(&here) < GRAZING * distance {
            continue;
        }
        let Some((nearest, farthest)) = ranges_at(scan, here.y.atan2(here.x)) else { continue };
        if nearest > distance + tolerance {
            sight.through += 1;
        } else if farthest >= distance - tolerance {
            sight.seen += 1;
        }
    }
    sight
}

/// The shortest and longest return of the beams on both sides of a direction, radians; `None` outside the field of view or where one has
/// no return.
fn ranges_at(scan: &LaserScan, direction: f64) -> Option<(f64, f64)> {
    let turned = (direction - scan.first_angle) / scan.angle_step;
    let period = TAU / scan.angle_step.abs();
    let beam = turned.rem_euclid(period).floor() as usize;
    let (one, other) = (*scan.ranges.get(beam)?, *scan.ranges.get(beam + 1)?);
    (one > 0.0 && other > 0.0).then_some((one.min(other), one.max(other)))
}

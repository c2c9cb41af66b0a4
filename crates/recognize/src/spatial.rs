//! Three-dimensional scans of keyframes: their contexts, and a planar scan of what stands upright.
//!
//! Measurements are made in the plane, as the graph is: [`slice()`] reduces a scan to the nearest upright thing in each direction.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use posecut_geometry::SE2;
use posecut_nclt_sensors::velodyne::Hit;
use posecut_scan::LaserScan;

use crate::scan_context::{ContextOptions, ScanContext};

/// Heights of a context are counted from this far below the origin of the body, metres, so that the ground is low and not negative. NCLT
/// does not say how high its body frame is above the ground.
const GROUND: f64 = 0.3;

/// The slice that is matched: heights above the origin of the body, metres. Below it there is the ground, and slopes reach into it.
const SLICE: [f64; 2] = [0.3, 1.8];
/// Directions of a slice.
const DIRECTIONS: usize = 720;
/// Two points of different lasers are on one upright thing if their horizontal distances differ by less than this, metres, and their
/// heights by more than the same. So slopes below 45 degrees are not upright.
const UPRIGHT: f64 = 0.15;
/// Ranges of a slice, metres: nearer is the robot itself, and beyond it the lasers are too far apart to tell what is upright.
const RANGES: std::ops::Range<f64> = 1.0..30.0;

/// A three-dimensional scan, reduced to what recognition needs of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SpatialScan {
    /// Its descriptor.
    pub context: ScanContext,
    /// What stands upright, as a planar scan.
    pub slice: LaserScan,
}

impl SpatialScan {
    /// Of hits in the frame of a body with z down. O(hits log hits).
    pub fn new(hits: &[Hit], options: &ContextOptions) -> Self {
        let points = hits.iter().map(|hit| Vector3::new(hit.point.x, hit.point.y, GROUND - hit.point.z));
        Self { context: ScanContext::new(points, options), slice: slice(hits) }
    }
}

/// The nearest upright thing in each direction, as a planar scan. O(hits log hits).
pub fn slice(hits: &[Hit]) -> LaserScan {
    let angle_step = TAU / DIRECTIONS as f64;
    let mut seen: Vec<Vec<(f64, f64, u8)>> = vec![Vec::new(); DIRECTIONS];
    for hit in hits {
        let (range, height) = (hit.point.xy().norm(), -hit.point.z);
        if RANGES.contains(&range) && (SLICE[0]..SLICE[1]).contains(&height) {
            let direction = (hit.point.y.atan2(hit.point.x) / angle_step).round();
            seen[direction.rem_euclid(DIRECTIONS as f64) as usize % DIRECTIONS]
                .push((range, height, hit.laser));
        }
    }
    let ranges = seen.iter_mut().map(|points| nearest_upright(points).unwrap_or(0.0)).collect();
    LaserScan { sensor: SE2::new(0.0, 0.0, 0.0), first_angle: 0.0, angle_step, ranges }
}

/// The horizontal distance of the nearest pair of points, by distance, height and laser, one above the other.
fn nearest_upright(points: &mut [(f64, f64, u8)]) -> Option<f64> {
    points.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.2.cmp(&other.2)));
    points.iter().enumerate().find_map(|(index, one)| {
        let above = points[index + 1..].iter().take_while(|other| other.0 - one.0 < UPRIGHT);
        let above: Vec<_> =
            above.filter(|other| other.2 != one.2 && (other.1 - one.1).abs() > UPRIGHT).collect();
        let sum: f64 = above.iter().map(|other| other.0).sum();
        // All points of the thing say where it is.
        (!above.is_empty()).then(|| (one.0 + sum) / (above.len() + 1) as f64)
    })
}

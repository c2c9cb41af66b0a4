//! Local maps: what the scanner saw a few metres before and after a keyframe.

use posecut_geometry::SE2;
use posecut_matching::Cloud;
use posecut_scan::LaserScan;

use crate::Routes;

/// The clouds of all keyframes, from which local maps are made.
pub struct Submaps<'a> {
    routes: &'a Routes,
    scans: Vec<Option<&'a LaserScan>>,
    clouds: Vec<Cloud>,
}

impl<'a> Submaps<'a> {
    /// Of the scans by keyframe. O(beams).
    pub fn new(routes: &'a Routes, scans: Vec<Option<&'a LaserScan>>) -> Self {
        let clouds = scans.iter().map(|scan| scan.map_or_else(Cloud::default, Cloud::of_scan)).collect();
        Self { routes, scans, clouds }
    }

    /// Whether a keyframe has a scan.
    pub fn has_scan(&self, node: usize) -> bool {
        !self.clouds[node].is_empty()
    }

    /// Whether no keyframe has a record of a scan, even one without returns.
    pub fn is_empty(&self) -> bool {
        self.scans.iter().all(Option::is_none)
    }

    /// The scans within a path length of a keyframe, metres, with the poses of their keyframes in its frame.
    pub fn scans(&self, node: usize, length: f64) -> impl Iterator<Item = (&LaserScan, SE2)> {
        let near = self.routes.within(node, length).iter();
        near.filter_map(move |&other| Some((self.scans[other]?, self.routes.between(node, other))))
    }

    /// What was seen within a path length of a keyframe, metres, in its frame, one point for each square of this side. A scanner that looks
    /// forwards sees the surroundings of a keyframe from the keyframes before it, and what is beside it from those. O(points log points).
    pub fn around(&self, node: usize, length: f64, side: f64) -> Cloud {
        let mut cloud = Cloud::default();
        for &other in self.routes.within(node, length) {
            cloud.add(&self.clouds[other], &self.routes.between(node, other));
        }
        cloud.thinned(side)
    }
}

//! Measurements: where one keyframe is in the frame of another, from what both saw.

use nalgebra::Matrix3;
use posecut_geometry::{LieGroup, SE2};
use posecut_matching::{Cloud, Field, IcpOptions, Neighbours, Sight, Window, agreement, align, sight};

use crate::Submaps;

/// The extents of the maps that are matched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extents {
    /// The local map of the reference, metres of path on each side.
    pub reference: f64,
    /// That of the query when it is searched.
    pub searched: f64,
    /// That of the query when it is aligned. A short one carries little drift of odometry.
    pub aligned: f64,
}

/// The measurement of a candidate.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The pose of the query in the frame of the reference.
    pub pose: SE2,
    /// The information matrix in the order x, y, theta, in 1/m^2, 1/(m rad), 1/rad^2.
    pub information: Matrix3<f64>,
    /// How far both agree about what they saw, 0 to 1: the share of the query's points that the reference has, times the share of the
    /// walls in sight that are seen and not seen through.
    pub agreement: f64,
}

/// Side of a square of local maps, metres, and of the cells of a field.
const SIDE: f64 = 0.1;
/// How far a wall's likelihood reaches, metres.
const BLUR: f64 = 0.12;
/// Points of the query in the search.
const POINTS: usize = 250;
/// The window around each heading: metres and radians.
const DISTANCE: f64 = 3.0;
const ANGLE: f64 = 0.16;
const ANGLE_STEP: f64 = 0.02;
/// The least score at which a search stops looking.
const LEAST: f64 = 0.3;
/// A point is confirmed by a wall within this distance, metres.
const CONFIRMED: f64 = 0.2;

/// A wall is seen through where a beam ends this far behind it, metres.
const THROUGH: f64 = 0.4;
/// Walls beyond this range say little: their bearing is uncertain, metres.
const RANGE: f64 = 8.0;

/// A keyframe prepared to be the reference of matches.
pub struct Reference {
    node: usize,
    cloud: Cloud,
    index: Neighbours,
    field: Field,
}

impl Reference {
    /// The local map around a keyframe. O(points + cells).
    pub fn new(submaps: &Submaps, node: usize, extents: &Extents) -> Self {
        let cloud = submaps.around(node, extents.reference, SIDE);
        let field = Field::new(&cloud, SIDE, BLUR);
        let index = Neighbours::new(&cloud.points, IcpOptions::default().first_distance);
        Self { node, cloud, index, field }
    }

    /// Measures a query from several headings. `None` if nothing matches.
    pub fn measure(
        &self,
        submaps: &Submaps,
        node: usize,
        headings: &[f64],
        extents: &Extents,
    ) -> Option<Measurement> {
        let searched = submaps.around(node, extents.searched, 2.0 * SIDE);
        let windows: Vec<Window> = headings
            .iter()
            .map(|heading| Window { middle: SE2::new(0.0, 0.0, *heading), distance: DISTANCE, angle: ANGLE })
            .collect();
        let found = self.field.search(&searched.at_most(POINTS), &windows, ANGLE_STEP, LEAST)?;
        let aligned = submaps.around(node, extents.aligned, 0.5 * SIDE);
        let options = IcpOptions::default();
        let alignment = align(&self.cloud, &self.index, &aligned, &found.pose, &options)?;
        let share = agreement(&self.cloud, &self.index, &searched, &alignment.pose, CONFIRMED).share();
        let sight = self.sight(submaps, node, &searched, &alignment.pose, extents).share();
        Some(Measurement {
            pose: alignment.pose,
            // Along a corridor the scans say nothing, but the pose is in the window.
            information: alignment.information + window_information(),
            agreement: share * sight,
        })
    }

    /// What the scans of each say about the map of the other.
    fn sight(&self, submaps: &Submaps, node: usize, query: &Cloud, pose: &SE2, extents: &Extents) -> Sight {
        let mut sum = Sight::default();
        for (scan, at) in submaps.scans(node, extents.searched) {
            sum = sum.and(sight(&self.cloud, scan, &pose.compose(&at), RANGE, THROUGH));
        }
        let back = pose.inverse();
        for (scan, at) in submaps.scans(self.node, extents.searched) {
            sum = sum.and(sight(query, scan, &back.compose(&at), RANGE, THROUGH));
        }
        sum
    }
}

/// The information of a pose that is anywhere in the window: the inverse of its squared half-widths.
fn window_information() -> Matrix3<f64> {
    let translation = DISTANCE.powi(-2);
    Matrix3::from_diagonal(&[translation, translation, ANGLE.powi(-2)].into())
}

//! The poses of a log at each scan.

use std::io::BufRead;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use posecut_geometry::SE3;
use posecut_geometry::interpolation::sample;

use super::reading::{RelationError, microseconds, rows};

/// A trajectory in the format of the TUM benchmark: a line `t x y z qx qy qz qw` each, in seconds and metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    times: Vec<i64>,
    poses: Vec<SE3>,
}

impl Track {
    /// Reads a trajectory. Poses are sorted by time; of several at one time the first counts. O(n log n).
    pub fn read(place: &str, reader: impl BufRead) -> Result<Self, RelationError> {
        let mut timed = Vec::new();
        rows(place, reader, "t x y z qx qy qz qw", |[time, x, y, z, i, j, k, w]| {
            let quaternion = Quaternion::new(w, i, j, k);
            // Not far from 1, or its columns are in another order.
            if !(0.9..1.1).contains(&quaternion.norm()) {
                return Err(format!("its quaternion has the norm {}, not 1", quaternion.norm()));
            }
            let rotation = UnitQuaternion::from_quaternion(quaternion);
            timed.push((microseconds(time), SE3::new(Vector3::new(x, y, z), rotation)));
            Ok(())
        })?;
        if timed.is_empty() {
            return Err(RelationError::Empty { place: place.to_owned(), what: "poses" });
        }
        timed.sort_by_key(|(time, _)| *time);
        timed.dedup_by_key(|(time, _)| *time);
        let (times, poses) = timed.into_iter().unzip();
        Ok(Self { times, poses })
    }

    /// The pose at a time, microseconds; `None` outside the trajectory.
    pub fn at(&self, time: i64) -> Option<SE3> {
        sample(&self.times, &self.poses, time)
    }
}

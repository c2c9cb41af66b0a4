//! A scan of a planar laser scanner.

use nalgebra::Vector2;
use posecut_geometry::{LieGroup, SE2};
use serde::{Deserialize, Serialize};

/// The ranges of one turn of a planar scanner, taken at a keyframe.
#[derive(Clone, Debug, PartialEq)]
pub struct LaserScan {
    /// Pose of the scanner in the frame of the robot, metres and radians.
    pub sensor: SE2,
    /// Direction of the first beam in the frame of the scanner, radians.
    pub first_angle: f64,
    /// Angle from one beam to the next, radians; not zero.
    pub angle_step: f64,
    /// Range of each beam, metres; 0 for a beam without a usable return.
    pub ranges: Vec<f64>,
}

/// A scan as its record has it.
#[derive(Debug, Deserialize, Serialize)]
pub(crate) struct Fields {
    pub(crate) kind: String,
    pub(crate) node: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) sensor: Option<[f64; 3]>,
    pub(crate) first_angle: f64,
    pub(crate) angle_step: f64,
    pub(crate) ranges: Vec<f64>,
}

impl LaserScan {
    /// The direction of a beam in the frame of the scanner, radians.
    pub fn angle(&self, beam: usize) -> f64 {
        self.first_angle + self.angle_step * beam as f64
    }

    /// The end points of the beams with a return, in the frame of the robot, in the order of the beams. O(beams).
    pub fn points(&self) -> impl Iterator<Item = Vector2<f64>> + '_ {
        self.numbered_points().map(|(_, point)| point)
    }

    /// The same with the number of each beam.
    pub fn numbered_points(&self) -> impl Iterator<Item = (usize, Vector2<f64>)> + '_ {
        self.ranges.iter().enumerate().filter(|(_, range)| **range > 0.0).map(|(beam, &range)| {
            let (sine, cosine) = self.angle(beam).sin_cos();
            let point = Vector2::new(range * cosine, range * sine);
            (beam, self.sensor.translation + self.sensor.rotation * point)
        })
    }

    /// The number of beams with a return.
    pub fn returns(&self) -> usize {
        self.ranges.iter().filter(|range| **range > 0.0).count()
    }

    /// The record of the scan, taken at this node, without a line end.
    pub fn record(&self, node: u64) -> serde_json::Result<String> {
        let sensor = [self.sensor.translation.x, self.sensor.translation.y, self.sensor.angle()];
        serde_json::to_string(&Fields {
            kind: crate::KIND.to_owned(),
            node,
            sensor: (sensor != [0.0; 3]).then_some(sensor),
            first_angle: self.first_angle,
            angle_step: self.angle_step,
            ranges: self.ranges.clone(),
        })
    }
}

impl Fields {
    /// The scan, or what is wrong with it.
    pub(crate) fn scan(self) -> Result<LaserScan, String> {
        if !self.first_angle.is_finite() {
            return Err(format!("its first_angle is {}", self.first_angle));
        }
        if !self.angle_step.is_finite() || self.angle_step == 0.0 {
            return Err(format!("its angle_step is {}", self.angle_step));
        }
        if let Some((beam, range)) =
            self.ranges.iter().enumerate().find(|(_, range)| !(range.is_finite() && **range >= 0.0))
        {
            return Err(format!("the range of beam {beam} is {range}"));
        }
        let sensor = self.sensor.unwrap_or_default();
        let Some(sensor) = SE2::from_components(&sensor) else {
            return Err(format!("its sensor is {sensor:?}"));
        };
        Ok(LaserScan {
            sensor,
            first_angle: self.first_angle,
            angle_step: self.angle_step,
            ranges: self.ranges,
        })
    }
}

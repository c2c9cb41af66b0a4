//! How much of what one scan sees another confirms.

use nalgebra::Vector2;
use posecut_geometry::SE2;

use crate::{Cloud, Neighbours};

/// What the reference says about the points of a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// The points of the query.
    pub points: usize,
    /// Those with a wall of the reference within the distance, facing the same way where both have a normal.
    pub confirmed: usize,
}

impl Agreement {
    /// The share of the points that the reference confirms; 0 without points.
    pub fn share(&self) -> f64 {
        if self.points == 0 { 0.0 } else { self.confirmed as f64 / self.points as f64 }
    }
}

/// The agreement of a query at a pose with the reference whose points are in the index, within a distance, metres (at most
/// the radius of the index). O(points of the query).
pub fn agreement(reference: &Cloud, index: &Neighbours, query: &Cloud, pose: &SE2, within: f64) -> Agreement {
    let confirms = |point: &Vector2<f64>, normal: &Option<Vector2<f64>>| {
        let here = pose.translation + pose.rotation * point;
        let turned = normal.map(|normal| pose.rotation * normal);
        let faces = |at: usize| match (reference.normals[at], turned) {
            (Some(wall), Some(turned)) => wall.dot(&turned) > 0.0,
            _ => true,
        };
        index.nearest(&here, within, faces).is_some()
    };
    let confirmed =
        query.points.iter().zip(&query.normals).filter(|(point, normal)| confirms(point, normal)).count();
    Agreement { points: query.len(), confirmed }
}

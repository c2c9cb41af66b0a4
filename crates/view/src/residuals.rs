//! How far the map is from what each edge measures.

use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{Dimension, Edge};
use serde::Serialize;

use crate::encode::series;

/// Lengths are rounded to this, metres.
pub(crate) const METRE_STEP: f64 = 1e-3;

/// Angles are rounded to this, degrees.
pub(crate) const DEGREE_STEP: f64 = 1e-2;

/// Stands for a number that is missing: no length or angle is negative.
const MISSING: f64 = -1.0;

/// Longest length that is written, metres.
const LONGEST: f64 = 1e12;

/// Lengths and angles of rigid motions, in steps; -1 stands for a missing one.
#[derive(Debug, Serialize)]
pub(crate) struct Motions {
    metres: String,
    degrees: String,
}

impl Motions {
    fn of(motions: &[Option<SE3>]) -> Self {
        let length = |motion: &SE3| {
            let [x, y, z] = motion.translation();
            x.hypot(y).hypot(z).min(LONGEST)
        };
        let angle = |motion: &SE3| motion.rotation_angle().to_degrees();
        Self {
            metres: series(motions.iter().map(|motion| motion.as_ref().map_or(MISSING, length)), METRE_STEP),
            degrees: series(motions.iter().map(|motion| motion.as_ref().map_or(MISSING, angle)), DEGREE_STEP),
        }
    }
}

/// The motions that edges measure.
pub(crate) fn measured(dimension: Dimension, edges: &[&Edge]) -> Motions {
    let motions: Vec<Option<SE3>> = edges.iter().map(|edge| motion(dimension, edge)).collect();
    Motions::of(&motions)
}

/// The motions from where edges measure their second node to where the map has it: `measurement^-1 * (from^-1 * to)`.
pub(crate) fn residuals(
    dimension: Dimension,
    edges: &[&Edge],
    ends: &[(usize, usize)],
    poses: &[Option<SE3>],
) -> Motions {
    let motions: Vec<Option<SE3>> = edges
        .iter()
        .zip(ends)
        .map(|(edge, &(from, to))| {
            let measured = motion(dimension, edge)?;
            Some(measured.between(&poses[from]?.between(&poses[to]?)))
        })
        .collect();
    Motions::of(&motions)
}

fn motion(dimension: Dimension, edge: &Edge) -> Option<SE3> {
    dimension.spatial(edge.measurement.as_deref()?)
}

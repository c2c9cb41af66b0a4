//! Scan Context: the descriptor of a three-dimensional scan (Kim and Kim, *Scan Context: Egocentric Spatial Descriptor for Place
//! Recognition Within 3D Point Cloud Map*, IROS 2018).
//!
//! The plane around a keyframe is divided into rings and sectors; each cell holds the height of its highest point, 0 if it has none
//! (equations 1 to 4). A robot that comes back with another heading sees the same columns, shifted. The distance of two contexts is the mean
//! of `1 - cosine` over the columns, at the best of all shifts (equations 6 and 7); columns that one of both does not have say nothing, as in
//! the authors' code. The key of a context is the share of cells of each
//! ring that have a point, which does not depend on the heading (equation 8).

use std::f64::consts::TAU;

use anyhow::ensure;
use nalgebra::Vector3;
use serde::Serialize;

use crate::columns::Columns;
use crate::places::Context;

/// Numbers in a key, of which contexts with fewer rings use the first ones.
pub const MOST_RINGS: usize = crate::polar_context::KEY;

/// The bins of a context, and when two contexts are alike: options of the program.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[cfg_attr(feature = "cli", group(skip))]
pub struct ContextOptions {
    /// Divide the plane around a keyframe into this many rings
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = ContextOptions::DEFAULT.context_rings, requires = "velodyne", help_heading = "Scan Context"))]
    pub context_rings: usize,

    /// Divide each ring into this many sectors
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = ContextOptions::DEFAULT.context_sectors, requires = "velodyne", help_heading = "Scan Context"))]
    pub context_sectors: usize,

    /// Describe points up to this horizontal distance from the keyframe, metres
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = ContextOptions::DEFAULT.context_radius, requires = "velodyne", help_heading = "Scan Context"))]
    pub context_radius: f64,

    /// Propose only keyframes whose contexts have at most this distance, 0 to 1; lower values give fewer candidates, and fewer wrong ones
    #[cfg_attr(feature = "cli", arg(long, value_name = "DISTANCE", default_value_t = ContextOptions::DEFAULT.context_distance, requires = "velodyne", help_heading = "Scan Context"))]
    pub context_distance: f64,
}

impl ContextOptions {
    /// 20 rings of 60 sectors up to 80 m, as in the paper. The distance is that which the authors' code recommends where later steps judge
    /// the candidates.
    pub const DEFAULT: Self =
        Self { context_rings: 20, context_sectors: 60, context_radius: 80.0, context_distance: 0.4 };

    /// Refuses meaningless values.
    ///
    /// # Errors
    ///
    /// There are no bins or too many, or a length or a distance is meaningless.
    pub fn check(&self) -> anyhow::Result<()> {
        ensure!(
            (1..=MOST_RINGS).contains(&self.context_rings),
            "--context-rings is {}; give 1 to {MOST_RINGS}",
            self.context_rings
        );
        ensure!(
            (4..=720).contains(&self.context_sectors),
            "--context-sectors is {}; give 4 to 720",
            self.context_sectors
        );
        ensure!(
            self.context_radius.is_finite() && self.context_radius > 0.0,
            "--context-radius is {}; give a positive length in metres",
            self.context_radius
        );
        ensure!(
            (0.0..=1.0).contains(&self.context_distance),
            "--context-distance is {}; give a number from 0 to 1",
            self.context_distance
        );
        Ok(())
    }
}

/// The context of a scan: heights in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanContext {
    columns: Columns,
}

impl ScanContext {
    /// The context of points around a keyframe: x, y in its frame, and the height above the ground, metres. Points at and below the ground
    /// count for nothing. O(points + cells).
    pub fn new(points: impl IntoIterator<Item = Vector3<f64>>, options: &ContextOptions) -> Self {
        let (rings, sectors) = (options.context_rings, options.context_sectors);
        let mut cells = vec![0.0_f32; rings * sectors];
        for point in points {
            let ring = (point.xy().norm() / options.context_radius * rings as f64) as usize;
            if ring < rings {
                let share = point.y.atan2(point.x).rem_euclid(TAU) / TAU;
                let sector = ((share * sectors as f64) as usize).min(sectors - 1);
                let cell = &mut cells[sector * rings + ring];
                *cell = cell.max(point.z as f32);
            }
        }
        Self { columns: Columns::new(rings, cells) }
    }

    /// Whether no cell has a point.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }
}

impl Context for ScanContext {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    /// The share of the cells of each ring that have a point; 0 beyond the last ring. O(cells).
    fn key(&self) -> [f64; MOST_RINGS] {
        let mut key = [0.0; MOST_RINGS];
        for column in self.columns.iter() {
            for (share, cell) in key.iter_mut().zip(column) {
                *share += f64::from(u8::from(*cell > 0.0)) / self.columns.sectors() as f64;
            }
        }
        key
    }
}

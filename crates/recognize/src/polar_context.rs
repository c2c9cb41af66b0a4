//! Polar contexts: descriptors of places that turn with the heading.
//!
//! The plane around a keyframe is divided into rings and sectors; each cell holds how much wall is in it (Kim and Kim, *Scan Context*,
//! IROS 2018, with the amount of wall instead of the height of the highest point). A robot that comes back with another heading sees the
//! same context with its sectors shifted. Each ring's discrete Fourier transform over the sectors keeps its magnitudes under such a shift:
//! the lowest magnitudes of rings are the key by which places are looked up.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use posecut_matching::{Cloud, OFF_GRID};

use crate::columns::Columns;
use crate::places::Context;

/// Rings, and sectors of each.
pub const RINGS: usize = 20;
/// Sectors of each ring.
pub const SECTORS: usize = 60;

/// Rings of a key: each stands for two rings of the context.
const KEY_RINGS: usize = 10;
/// Magnitudes of each ring of a key, from that of the mean on.
const MAGNITUDES: usize = 3;
/// Numbers in a key.
pub const KEY: usize = KEY_RINGS * MAGNITUDES;

/// Scanners report ranges in whole centimetres or millimetres, in directions of whole parts of a degree. The borders of cells lie off such
/// numbers, so that the last bit of a pose moves no point to another cell: those of rings by this much, metres, and those of sectors by
/// [`OFF_GRID`] of a sector. Only differences of headings matter, so that every part would do.
const OFF_MILLIMETRES: f64 = 0.000_4;

/// The context of a place.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarContext {
    columns: Columns,
}

impl PolarContext {
    /// The context of a local map around the origin of its frame up to a radius, metres. The map should have one point for each square
    /// of some side, so that points measure wall. O(points).
    pub fn new(cloud: &Cloud, radius: f64) -> Self {
        let mut cells = vec![0.0_f32; RINGS * SECTORS];
        for point in &cloud.points {
            let ring = ((point.norm() + OFF_MILLIMETRES) / radius * RINGS as f64) as usize;
            if ring < RINGS {
                cells[sector(point) * RINGS + ring] += 1.0;
            }
        }
        // The root keeps one long wall from outweighing all else.
        for cell in &mut cells {
            *cell = cell.sqrt();
        }
        Self { columns: Columns::new(RINGS, cells) }
    }
}

impl Context for PolarContext {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    /// The magnitudes of the lowest coefficients of each pair of rings: the same for every heading. O(cells).
    fn key(&self) -> [f64; KEY] {
        let mut key = [0.0; KEY];
        for ring in 0..KEY_RINGS {
            for order in 0..MAGNITUDES {
                let (mut real, mut imaginary) = (0.0, 0.0);
                for (sector, column) in self.columns.iter().enumerate() {
                    let value = f64::from(column[2 * ring] + column[2 * ring + 1]);
                    let (sine, cosine) = (TAU * (order * sector) as f64 / SECTORS as f64).sin_cos();
                    real += value * cosine;
                    imaginary += value * sine;
                }
                key[ring * MAGNITUDES + order] = real.hypot(imaginary) / SECTORS as f64;
            }
        }
        key
    }
}

fn sector(point: &Vector2<f64>) -> usize {
    let turns = (point.y.atan2(point.x) / TAU + OFF_GRID / SECTORS as f64).rem_euclid(1.0);
    ((turns * SECTORS as f64) as usize).min(SECTORS - 1)
}

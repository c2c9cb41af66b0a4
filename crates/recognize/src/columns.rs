//! Columns of contexts: the plane around a keyframe by sector, then by ring.
//!
//! A robot that comes back with another heading sees the same columns, shifted.

use std::f64::consts::TAU;

/// What a context has in its cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    rings: usize,
    /// By sector, then by ring.
    cells: Vec<f32>,
    /// The length of each sector's column.
    norms: Vec<f32>,
}

impl Columns {
    /// Of the cells by sector, then by ring. O(cells).
    pub fn new(rings: usize, cells: Vec<f32>) -> Self {
        let length = |column: &[f32]| column.iter().map(|cell| cell * cell).sum::<f32>().sqrt();
        let norms = cells.chunks_exact(rings).map(length).collect();
        Self { rings, cells, norms }
    }

    /// The number of sectors.
    pub fn sectors(&self) -> usize {
        self.norms.len()
    }

    /// The cells of each sector, by ring.
    pub fn iter(&self) -> impl Iterator<Item = &[f32]> {
        self.cells.chunks_exact(self.rings)
    }

    /// Whether all cells are zero.
    pub fn is_empty(&self) -> bool {
        self.norms.iter().all(|norm| *norm == 0.0)
    }

    /// How alike the other one's columns are when shifted by each number: the mean cosine of columns that both have. Where these are less
    /// than a third of all, the rest counts as different: hardly anything is known there. O(sectors^2 * rings).
    pub fn similarities(&self, other: &Self) -> Vec<f64> {
        (0..self.sectors()).map(|shift| self.similarity(other, shift)).collect()
    }

    fn similarity(&self, other: &Self, shift: usize) -> f64 {
        let (sectors, rings) = (self.sectors(), self.rings);
        let (mut sum, mut count) = (0.0_f32, 0_usize);
        for sector in 0..sectors {
            let turned = (sector + sectors - shift) % sectors;
            let norms = self.norms[sector] * other.norms[turned];
            if norms > 0.0 {
                let one = &self.cells[sector * rings..][..rings];
                let two = &other.cells[turned * rings..][..rings];
                sum += one.iter().zip(two).map(|(one, two)| one * two).sum::<f32>() / norms;
                count += 1;
            }
        }
        f64::from(sum) / count.max(sectors.div_ceil(3)) as f64
    }
}

/// The heading of a shift: where the x axis of the shifted context's frame points in the frame of the other, radians.
pub fn heading(shift: usize, sectors: usize) -> f64 {
    shift as f64 * TAU / sectors as f64
}

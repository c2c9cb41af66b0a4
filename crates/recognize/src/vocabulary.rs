//! Words of laser scans: the shapes around the points of a local map.
//!
//! Every half metre of wall is described by the walls around it, in a frame that its normal gives (a shape context: Belongie, Malik and
//! Puzicha, PAMI 24, 2002; on laser scans as in FLIRT: Tipaldi and Arras, ICRA 2010). Descriptors are grouped by k-means; the number of
//! the group is the word. The vocabulary is learnt from the graph itself.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use posecut_matching::Cloud;
use posecut_random::random;
use rayon::prelude::*;

use crate::k_means::{centres, nearest};
use crate::{Submaps, Words};

/// Rings of a shape context end at these distances, metres.
const RINGS: [f64; 3] = [0.6, 1.2, 2.4];
/// Sectors of each ring.
const SECTORS: usize = 8;
/// Numbers of a descriptor.
const LENGTH: usize = RINGS.len() * SECTORS;

type Shape = [f32; LENGTH];

/// Distance between described points, and side of the squares of the map that describes them, metres.
const SPACING: f64 = 0.5;
const SIDE: f64 = 0.1;
/// Shapes from which the vocabulary is learnt, and rounds of k-means.
const LEARNT: usize = 20_000;
const ROUNDS: usize = 12;

/// The words of the keyframes of local maps within a path length of each, metres, with a vocabulary of a size. O(shapes * size).
pub fn words(submaps: &Submaps, keyframes: usize, length: f64, size: usize, seed: u64) -> Words {
    let shapes: Vec<Vec<Shape>> =
        (0..keyframes).into_par_iter().map(|node| shapes(&submaps.around(node, length, SIDE))).collect();
    let all: Vec<&Shape> = shapes.iter().flatten().collect();
    if all.is_empty() {
        return Words::new(vec![Vec::new(); keyframes], 0);
    }
    let step = all.len().div_ceil(LEARNT);
    let learnt: Vec<&Shape> = all.into_iter().step_by(step).collect();
    let centres = centres(&learnt, size, ROUNDS, &mut random(seed, "vocabulary"));
    let bags = shapes
        .par_iter()
        .map(|shapes| shapes.iter().map(|shape| nearest(&centres, shape).0).collect())
        .collect();
    Words::new(bags, centres.len())
}

/// The shapes around points at equal distances. O(described points * points).
fn shapes(cloud: &Cloud) -> Vec<Shape> {
    let described = cloud.thinned(SPACING);
    let around = |(point, normal): (&Vector2<f64>, &Option<Vector2<f64>>)| {
        let normal = (*normal)?;
        let mut shape = [0.0_f32; LENGTH];
        for other in &cloud.points {
            let offset = other - point;
            let distance = offset.norm();
            let Some(ring) = RINGS.iter().position(|end| distance < *end) else { continue };
            let direction = (normal.x * offset.y - normal.y * offset.x).atan2(normal.dot(&offset));
            // Sectors are centred on the wall and its normal, so that a small turn of the normal moves no wall to another sector.
            let sector = (direction.rem_euclid(TAU) / TAU * SECTORS as f64).round() as usize % SECTORS;
            shape[ring * SECTORS + sector] += 1.0;
        }
        let shape = shape.map(f32::sqrt);
        let norm = shape.iter().map(|cell| cell * cell).sum::<f32>().sqrt();
        Some(shape.map(|cell| cell / norm.max(f32::MIN_POSITIVE)))
    };
    described.points.iter().zip(&described.normals).filter_map(around).collect()
}

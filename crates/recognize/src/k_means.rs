//! Groups of vectors by k-means, as words of scans and as parts of the index.
//!
//! Lloyd's iteration from the start of Arthur and Vassilvitskii (*k-means++: the advantages of careful seeding*, SODA 2007).

use posecut_random::ChaCha8Rng;
use posecut_random::rand::Rng;
use rayon::prelude::*;

/// The centres of at most `size` groups: fewer if there are fewer different vectors. The vectors are not empty.
/// O(vectors * size * rounds).
pub(crate) fn centres<const LENGTH: usize>(
    vectors: &[&[f32; LENGTH]],
    size: usize,
    rounds: usize,
    random: &mut ChaCha8Rng,
) -> Vec<[f32; LENGTH]> {
    let mut centres = start(vectors, size, random);
    for _ in 0..rounds {
        let groups: Vec<usize> = vectors.par_iter().map(|vector| nearest(&centres, vector).0).collect();
        // One thread adds, in the order of the vectors: sums of floating-point numbers depend on it.
        let mut sums = vec![([0.0_f32; LENGTH], 0_u32); centres.len()];
        for (group, vector) in groups.iter().zip(vectors) {
            sums[*group].1 += 1;
            sums[*group].0.iter_mut().zip(vector.iter()).for_each(|(sum, number)| *sum += number);
        }
        for (centre, (sum, count)) in centres.iter_mut().zip(sums) {
            if count > 0 {
                *centre = sum.map(|number| number / count as f32);
            }
        }
    }
    centres
}

/// Vectors that are far from each other: each is drawn with a probability in proportion to its squared distance from those before.
fn start<const LENGTH: usize>(
    vectors: &[&[f32; LENGTH]],
    size: usize,
    random: &mut ChaCha8Rng,
) -> Vec<[f32; LENGTH]> {
    let mut centres: Vec<[f32; LENGTH]> = vec![*vectors[0]];
    let mut distances: Vec<f32> = vectors.iter().map(|vector| squared(vector, &centres[0])).collect();
    while centres.len() < size.min(vectors.len()) {
        let total: f64 = distances.iter().map(|distance| f64::from(*distance)).sum();
        if total <= 0.0 {
            break;
        }
        let mut left = total * (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let chosen = distances
            .iter()
            .position(|distance| {
                left -= f64::from(*distance);
                left < 0.0
            })
            .unwrap_or(vectors.len() - 1);
        let centre = *vectors[chosen];
        for (distance, vector) in distances.iter_mut().zip(vectors) {
            *distance = distance.min(squared(vector, &centre));
        }
        centres.push(centre);
    }
    centres
}

/// The nearest centre and its squared distance; of equal ones the first. O(centres).
pub(crate) fn nearest<const LENGTH: usize>(
    centres: &[[f32; LENGTH]],
    vector: &[f32; LENGTH],
) -> (usize, f32) {
    let mut best = (0, f32::INFINITY);
    for (index, centre) in centres.iter().enumerate() {
        let distance = squared(centre, vector);
        if distance < best.1 {
            best = (index, distance);
        }
    }
    best
}

/// The squared distance of two vectors. O(length).
pub(crate) fn squared<const LENGTH: usize>(one: &[f32; LENGTH], other: &[f32; LENGTH]) -> f32 {
    one.iter().zip(other).map(|(one, other)| (one - other) * (one - other)).sum()
}

//! How far the covariances are off, from the candidates themselves.

use serde::Serialize;

use crate::consistency::Pairs;
use crate::nearest::Nearest;
use crate::spread::Spatial;

/// Candidates looked at; more would not change the estimate.
const SAMPLE: usize = 4000;
/// Neighbours each is held against.
const NEIGHBOURS: usize = 4;
/// Pairs below which there is no estimate.
const FEWEST: usize = 50;
/// Width of the kernel that smooths the histogram of ln(d^2), and the step of its grid.
const WIDTH: f64 = 0.35;
const STEP: f64 = 0.05;
/// The estimate lies within e^-12 and e^12.
const RANGE: f64 = 12.0;

/// An estimate of the factor by which covariances must be multiplied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScaleEstimate {
    /// The factor: 1 if the covariances are right, below 1 if they are too loose.
    pub scale: f64,
    /// Pairs of neighbouring candidates that it comes from.
    pub pairs: usize,
}

/// Estimates the scale of the covariances from pairs of candidates that are neighbours by distance travelled.
///
/// Neighbours that are both correct have d^2 = scale * chi-square; the density of its logarithm peaks at
/// ln(scale * DOF). Pairs with a false candidate spread over many decades, with peaks of their own. What those look like
/// is seen when the second of each pair has its measurement exchanged for that of a candidate far away: false pairs look
/// the same afterwards, and correct ones agree no more. The highest peak of the difference of both densities is taken. It
/// needs measurements that differ by more than their noise. False candidates that come in groups agree with each other;
/// where they are the majority, their noise is taken for everybody's.
///
/// `None` with fewer than 50 pairs. O(sample * log N).
pub fn estimate_scale<G: Spatial<DOF>, const DOF: usize>(pairs: &Pairs<'_, G, DOF>) -> Option<ScaleEstimate> {
    let count = pairs.len();
    let all: Vec<usize> = (0..count).collect();
    let nearest = Nearest::new(pairs, &all, [1.0, 1.0]);
    let step = count.div_ceil(SAMPLE).max(1);
    let (mut near, mut exchanged) = (Vec::new(), Vec::new());
    let logarithm = |squared: Option<f64>| {
        let distance = squared? / DOF as f64;
        (distance > 0.0).then(|| distance.ln().clamp(-RANGE, RANGE))
    };
    for candidate in (0..count).step_by(step) {
        for (turn, neighbour) in
            nearest.of(pairs.position(candidate), candidate, NEIGHBOURS).into_iter().enumerate()
        {
            near.extend(logarithm(pairs.squared_distance(candidate, neighbour)));
            // Steps of the golden section spread over all candidates without a pattern.
            let offset = (count as f64 * (0.618_034 * (turn + 1) as f64).fract()) as usize;
            exchanged.extend(logarithm(pairs.exchanged(candidate, neighbour, (neighbour + offset) % count)));
        }
    }
    if near.len() < FEWEST {
        return None;
    }
    let excess =
        density(&near).into_iter().zip(density(&exchanged)).map(|(near, exchanged)| near - exchanged);
    let (peak, _) =
        excess.enumerate().max_by(|one, other| one.1.total_cmp(&other.1).then(other.0.cmp(&one.0)))?;
    Some(ScaleEstimate { scale: (peak as f64 * STEP - RANGE).exp(), pairs: near.len() })
}

/// A histogram smoothed by a Gaussian kernel, on the grid from -RANGE to RANGE.
fn density(values: &[f64]) -> Vec<f64> {
    let cells = (2.0 * RANGE / STEP) as usize + 1;
    let mut histogram = vec![0.0; cells];
    for value in values {
        histogram[(((value + RANGE) / STEP).round() as usize).min(cells - 1)] += 1.0 / values.len() as f64;
    }
    let reach = (4.0 * WIDTH / STEP) as usize;
    (0..cells)
        .map(|cell| {
            (cell.saturating_sub(reach)..(cell + reach + 1).min(cells))
                .map(|other| {
                    let offset = (other as f64 - cell as f64) * STEP / WIDTH;
                    histogram[other] * (-0.5 * offset * offset).exp()
                })
                .sum()
        })
        .collect()
}

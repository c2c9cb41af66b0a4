//! Projected gradient ascent of the penalised density.

use crate::Affinity;

/// The most steps for one penalty.
const MOST_STEPS: usize = 500;
/// Ascent for one penalty ends when a step gains less than this share of the value.
const GAIN_TOLERANCE: f64 = 1e-6;
/// A component below this share of the largest one counts as zero.
const ZERO: f64 = 1e-7;
/// The most step lengths tried before the ascent counts as finished.
const MOST_HALVINGS: usize = 60;

/// A local maximum of the relaxation.
#[derive(Clone, Debug, PartialEq)]
pub struct Ascent {
    /// The unit vector u, all components at least 0.
    pub solution: Vec<f64>,
    /// Gradient steps over all penalties.
    pub steps: usize,
}

/// Climbs from a start (not negative, not zero) to a local maximum of
///
/// ```text
/// F_d(u) = u^T M u - d u^T C u   over   |u| = 1, u >= 0
/// ```
///
/// where `C_ij = 1` for inconsistent pairs. Raises the penalty d until no inconsistent pair has both components above zero.
/// The solution is then one of the constrained problem, and d need not exceed the number of vertices (Lusk, Fathian, How,
/// 2021, problem (5) and algorithm 1). A step is projected on the positive part of the sphere and halved until it gains.
///
/// Without a penalty there is a single maximum, the leading eigenvector of M, which every start reaches (Perron and
/// Frobenius). With `free`, the ascent climbs there first. Without it, the first penalty is the one that balances the
/// conflicts of the start, and other starts may reach other maxima.
pub fn ascend(affinity: &Affinity, start: &[f64], free: bool) -> Ascent {
    let mut ascent = Ascent { solution: start.to_vec(), steps: 0 };
    normalise(&mut ascent.solution);
    let mut penalty = if free { 0.0 } else { conflict(affinity, &mut ascent.solution).unwrap_or(0.0) };
    loop {
        climb(affinity, penalty, &mut ascent);
        let Some(balance) = conflict(affinity, &mut ascent.solution) else { return ascent };
        if penalty > affinity.len() as f64 {
            return ascent;
        }
        // The penalty grows by a quarter of the one at which the gradient of an average conflicting vertex changes sign, or
        // by a constant factor if that is more.
        penalty = (penalty * 1.5).max(penalty + balance * 0.25).max(balance * 0.25);
    }
}

/// Ascends for one penalty until a step no longer gains.
fn climb(affinity: &Affinity, penalty: f64, ascent: &mut Ascent) {
    let mut gradient = penalised(affinity, penalty, &ascent.solution);
    let mut value = dot(&ascent.solution, &gradient);
    let mut length = 1.0;
    for _ in 0..MOST_STEPS {
        let mut found = None;
        for _ in 0..MOST_HALVINGS {
            let mut next: Vec<f64> = ascent
                .solution
                .iter()
                .zip(&gradient)
                .map(|(component, slope)| (component + length * slope).max(0.0))
                .collect();
            if normalise(&mut next) {
                let next_gradient = penalised(affinity, penalty, &next);
                let next_value = dot(&next, &next_gradient);
                if next_value > value {
                    found = Some((next, next_gradient, next_value));
                    break;
                }
            }
            length *= 0.5;
        }
        let Some((next, next_gradient, next_value)) = found else { return };
        ascent.steps += 1;
        let gain = next_value - value;
        (ascent.solution, gradient, value) = (next, next_gradient, next_value);
        if gain <= GAIN_TOLERANCE * value.abs() {
            return;
        }
        length *= 2.0;
    }
}

/// M u - d C u.
fn penalised(affinity: &Affinity, penalty: f64, u: &[f64]) -> Vec<f64> {
    let (weighted, inconsistent) = affinity.products(u);
    weighted.iter().zip(&inconsistent).map(|(weighted, against)| weighted - penalty * against).collect()
}

/// Sets tiny components to zero. Returns the mean of (M u)_i / (C u)_i over the vertices in conflict, `None` if there are
/// none.
fn conflict(affinity: &Affinity, u: &mut [f64]) -> Option<f64> {
    let largest = u.iter().copied().fold(0.0, f64::max);
    for component in u.iter_mut() {
        if *component <= ZERO * largest {
            *component = 0.0;
        }
    }
    normalise(u);
    let (weighted, inconsistent) = affinity.products(u);
    let (mut sum, mut count) = (0.0, 0_usize);
    for vertex in 0..u.len() {
        // This is a difference of sums: below the bound it is a rounding error, not a conflicting component.
        if u[vertex] > 0.0 && inconsistent[vertex] > 0.1 * ZERO * largest {
            sum += weighted[vertex] / inconsistent[vertex];
            count += 1;
        }
    }
    (count > 0).then(|| (sum / count as f64).min(affinity.len() as f64))
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Scales to length 1; false if the length is zero or not finite.
pub(crate) fn normalise(vector: &mut [f64]) -> bool {
    let length = dot(vector, vector).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return false;
    }
    for component in vector {
        *component /= length;
    }
    true
}

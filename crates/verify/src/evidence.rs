//! Log-likelihood ratios of correct loops against chance.

use nalgebra::{SMatrix, SVector};

/// Degrees of freedom of the t distribution of errors: its heavy tails withstand a few gross errors.
pub(crate) const TAIL: f64 = 4.0;
/// Degrees of freedom at which errors are practically Gaussian.
pub(crate) const GAUSSIAN: f64 = 1e6;
/// Squared distance per degree of freedom beyond which an error contradicts in any case. Without this limit, the heavy tail
/// of a correct error outweighs chance where chance is spread widely.
const GATE: f64 = 100.0 / 3.0;
/// Largest weight of one comparison in either direction, nats, so that no single loop decides alone.
pub(crate) const CLIP: f64 = 20.0;

/// The evidence of one loop's error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evidence {
    /// ln t(e; S) - ln t(e; S + R)
    pub(crate) chance: f64,
    /// ln t(e; S) - ln t(e; S + L'), where L' is a local error: the right neighbourhood, measured wrongly.
    pub(crate) local: f64,
    /// The value of `chance` without any error: how well the prediction can distinguish correct from chance.
    pub(crate) most: f64,
    /// e^T S^-1 e
    pub(crate) squared_distance: f64,
    /// Whether the squared distance alone contradicts, whatever the alternatives are.
    beyond: bool,
}

impl Evidence {
    /// The weight of a comparison that ignores local errors.
    pub(crate) fn distant(&self) -> f64 {
        if self.beyond { -CLIP } else { self.chance }
    }

    /// The weight of a comparison: the evidence against chance, or against a local error if this explains the loop better.
    pub(crate) fn weight(&self) -> f64 {
        if self.beyond {
            -CLIP
        } else if self.local < LOCAL_DOUBT {
            self.chance.min(self.local)
        } else {
            self.chance
        }
    }
}

/// Log-likelihood ratio below which a local error explains a loop better than noise.
const LOCAL_DOUBT: f64 = -2.0;

/// Compares a correct loop, whose error is multivariate t with scale matrix S, with a loop that closes by chance, whose error
/// has the scale matrix S + R. Both have `tail` degrees of freedom. `None` where S is not positive definite.
pub(crate) fn compare<const DOF: usize>(
    error: &SVector<f64, DOF>,
    correct: &SMatrix<f64, DOF, DOF>,
    apart: &SMatrix<f64, DOF, DOF>,
    local: &SMatrix<f64, DOF, DOF>,
    tail: f64,
) -> Option<Evidence> {
    let near = Elimination::of(correct, error)?;
    let far = Elimination::of(&(correct + apart), error)?;
    let local = Elimination::of(&(correct + local), error)?;
    let ratio = |wide: &Elimination| {
        0.5 * (wide.log_determinant() - near.log_determinant())
            + 0.5
                * (tail + DOF as f64)
                * ((1.0 + wide.squared / tail).ln() - (1.0 + near.squared / tail).ln())
    };
    Some(Evidence {
        chance: ratio(&far),
        local: ratio(&local),
        most: 0.5 * (far.log_determinant() - near.log_determinant()),
        squared_distance: near.squared,
        beyond: near.squared > GATE * DOF as f64,
    })
}

/// Range in which the determinant stays a plain product of pivots. Outside it, its logarithm is split off, so that the
/// product neither overflows nor vanishes, whatever the units.
const RANGE: std::ops::Range<f64> = 1e-150..1e150;

/// L D L^T of a covariance, applied to a right-hand side at the same time.
struct Elimination {
    determinant: f64,
    /// The logarithm of the factor split off from the determinant: 0 unless the determinant would be out of range.
    log_rest: f64,
    squared: f64,
}

impl Elimination {
    fn of<const DOF: usize>(matrix: &SMatrix<f64, DOF, DOF>, error: &SVector<f64, DOF>) -> Option<Self> {
        let mut remaining = *matrix;
        let mut whitened = *error;
        let (mut determinant, mut log_rest, mut squared) = (1.0_f64, 0.0, 0.0);
        for column in 0..DOF {
            let pivot = remaining[(column, column)];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            if !RANGE.contains(&(determinant * pivot)) {
                log_rest += determinant.ln();
                determinant = 1.0;
            }
            determinant *= pivot;
            squared += whitened[column] * whitened[column] / pivot;
            for later in column + 1..DOF {
                let ratio = remaining[(later, column)] / pivot;
                whitened[later] -= ratio * whitened[column];
                for row in later..DOF {
                    remaining[(row, later)] -= ratio * remaining[(row, column)];
                }
            }
        }
        let finite = determinant.is_finite() && f64::is_finite(log_rest) && f64::is_finite(squared);
        finite.then_some(Self { determinant, log_rest, squared })
    }

    fn log_determinant(&self) -> f64 {
        self.determinant.ln() + self.log_rest
    }
}

/// The quantile of chi-square at the probability of a normal quantile, which is 0 for the median (Wilson and Hilferty 1931).
pub(crate) fn chi_square_quantile(degrees: usize, normal: f64) -> f64 {
    let degrees = degrees as f64;
    let spread = 2.0 / (9.0 * degrees);
    degrees * (1.0 - spread + normal * spread.sqrt()).powi(3)
}

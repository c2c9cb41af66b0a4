//! Log-likelihood ratios: correct against chance.

use nalgebra::{SMatrix, SVector};

/// Degrees of freedom of the t distribution of errors: tails that a few gross errors do not beat.
pub(crate) const TAIL: f64 = 4.0;
/// The same for errors as good as Gaussian.
pub(crate) const GAUSSIAN: f64 = 1e6;
/// Squared distance per degree of freedom beyond which an error contradicts, whatever chance says: without this limit the
/// heavy tail of a correct error outweighs chance where chance is spread widely.
const GATE: f64 = 100.0 / 3.0;
/// Largest weight of one comparison in either direction, nats: no single loop decides alone.
pub(crate) const CLIP: f64 = 20.0;

/// What the error of one loop says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evidence {
    /// ln t(e; S) - ln t(e; S + R)
    pub(crate) chance: f64,
    /// ln t(e; S) - ln t(e; S + L'), L' a local error: the right neighbourhood, wrongly measured.
    pub(crate) local: f64,
    /// What `chance` would be without any error: how well the prediction can tell correct from chance.
    pub(crate) most: f64,
    /// e^T S^-1 e
    pub(crate) squared_distance: f64,
    /// Whether the squared distance contradicts, whatever the alternatives say.
    beyond: bool,
}

impl Evidence {
    /// The weight of a comparison where local errors are out of sight.
    pub(crate) fn distant(&self) -> f64 {
        if self.beyond { -CLIP } else { self.chance }
    }

    /// The weight of a comparison: what speaks against chance, unless a local error explains the loop better.
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

/// Compares a correct loop, whose error is multivariate t with scale matrix S, with one that closes by chance, whose
/// error has the scale matrix S + R; `tail` degrees of freedom. `None` where S is not positive definite.
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

/// Determinants whose logarithm is taken once: a product of pivots must neither overflow nor vanish, whatever the units.
const RANGE: std::ops::Range<f64> = 1e-150..1e150;

/// L D L^T of a covariance, with a right-hand side carried along.
struct Elimination {
    determinant: f64,
    /// The logarithm of what the determinant is to be multiplied by: 0 unless it would be out of range.
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

/// The quantile of chi-square at that of the normal distribution, which is 0 for the median (Wilson and Hilferty 1931).
pub(crate) fn chi_square_quantile(degrees: usize, normal: f64) -> f64 {
    let degrees = degrees as f64;
    let spread = 2.0 / (9.0 * degrees);
    degrees * (1.0 - spread + normal * spread.sqrt()).powi(3)
}

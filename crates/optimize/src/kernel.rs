//! Robust kernels: how much of a residual's square an edge is charged.

/// A robust kernel `rho(s)` of the squared Mahalanobis residual `s = e^T Omega e`.
///
/// `rho(s)` is close to `s` for small `s`; its derivative is the edge's weight. Forms after Zhang, "Parameter
/// estimation techniques: a tutorial", 1997, except where said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// `s` up to `k^2`, then `2 k sqrt(s) - k^2`. Convex; parameter k in standard deviations.
    Huber(f64),
    /// `c^2 ln(1 + s / c^2)`. Parameter c in standard deviations.
    Cauchy(f64),
    /// `s c^2 / (c^2 + s)`. Parameter c in standard deviations.
    GemanMcClure(f64),
    /// Dynamic covariance scaling (Agarwal, Tipaldi, Spinello, Stachniss, Burgard, 2013) in closed form: `s` up to
    /// `phi`, then `phi (3 s - phi) / (s + phi)`. Parameter phi is a squared residual.
    DynamicCovarianceScaling(f64),
}

impl Kernel {
    /// The kernel's parameter.
    pub fn parameter(self) -> f64 {
        match self {
            Self::Huber(parameter)
            | Self::Cauchy(parameter)
            | Self::GemanMcClure(parameter)
            | Self::DynamicCovarianceScaling(parameter) => parameter,
        }
    }

    /// `rho(s)` and the weight `rho'(s)`, for `s >= 0`.
    pub fn evaluate(self, squared: f64) -> (f64, f64) {
        match self {
            Self::Huber(k) if squared <= k * k => (squared, 1.0),
            Self::Huber(k) => {
                let root = squared.sqrt();
                (k * (2.0 * root - k), k / root)
            }
            Self::Cauchy(c) => {
                let share = squared / (c * c);
                (c * c * share.ln_1p(), 1.0 / (1.0 + share))
            }
            Self::GemanMcClure(c) => {
                let share = c * c / (c * c + squared);
                (squared * share, share * share)
            }
            Self::DynamicCovarianceScaling(phi) if squared <= phi => (squared, 1.0),
            Self::DynamicCovarianceScaling(phi) => {
                let scale = 2.0 * phi / (phi + squared);
                (phi * (3.0 * squared - phi) / (squared + phi), scale * scale)
            }
        }
    }
}

/// Cost and weight of a squared residual under an optional kernel.
pub(crate) fn charge(kernel: Option<Kernel>, squared: f64) -> (f64, f64) {
    kernel.map_or((squared, 1.0), |kernel| kernel.evaluate(squared))
}

//! Robust kernels: the cost of an edge as a function of its squared residual.

/// A robust kernel `rho(s)` of the squared Mahalanobis residual `s = e^T Omega e`.
///
/// `rho(s)` is close to `s` for small `s`; its derivative is the edge's weight. The forms follow Zhang, "Parameter estimation
/// techniques: a tutorial", 1997, unless another source is named.
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
    /// The surrogate of truncated least squares `min(s, c^2)` with convexity `mu` (Yang, Antonante, Tzoumas, Carlone,
    /// 2020, equation 8): `s` up to `c^2 mu / (mu + 1)`, `c^2` from `c^2 (mu + 1) / mu`, and
    /// `2 c sqrt(s mu (mu + 1)) - mu (c^2 + s)` between. Convex as mu tends to 0, the cost itself at infinity.
    Truncated {
        /// Width c in standard deviations.
        width: f64,
        /// Convexity mu.
        convexity: f64,
    },
}

impl Kernel {
    /// The kernel's parameter.
    pub fn parameter(self) -> f64 {
        match self {
            Self::Huber(parameter)
            | Self::Cauchy(parameter)
            | Self::GemanMcClure(parameter)
            | Self::DynamicCovarianceScaling(parameter)
            | Self::Truncated { width: parameter, .. } => parameter,
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
            Self::Truncated { width, convexity } => truncated(width * width, convexity, squared),
        }
    }
}

/// Surrogate of truncated least squares and its derivative.
fn truncated(bound: f64, convexity: f64, squared: f64) -> (f64, f64) {
    let share = 1.0 / (1.0 + 1.0 / convexity);
    if squared <= bound * share {
        (squared, 1.0)
    } else if squared * share >= bound {
        (bound, 0.0)
    } else {
        let root = (bound * convexity * (convexity + 1.0)).sqrt();
        let length = squared.sqrt();
        (2.0 * root * length - convexity * (bound + squared), root / length - convexity)
    }
}

/// Cost and weight of a squared residual under an optional kernel.
#[inline]
pub fn charge(kernel: Option<Kernel>, squared: f64) -> (f64, f64) {
    kernel.map_or((squared, 1.0), |kernel| kernel.evaluate(squared))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_derivatives_and_costs_are_continuous() {
        let kernels = [
            Kernel::Huber(1.3),
            Kernel::Cauchy(0.7),
            Kernel::GemanMcClure(2.0),
            Kernel::DynamicCovarianceScaling(1.5),
            Kernel::Truncated { width: 2.0, convexity: 1e-3 },
            Kernel::Truncated { width: 2.0, convexity: 0.8 },
            Kernel::Truncated { width: 2.0, convexity: 50.0 },
        ];
        for kernel in kernels {
            for index in 1..2000 {
                let squared = f64::from(index) * 0.0131;
                let step = 1e-6;
                let slope =
                    (kernel.evaluate(squared + step).0 - kernel.evaluate(squared - step).0) / (2.0 * step);
                let weight = kernel.evaluate(squared).1;
                assert!((slope - weight).abs() < 1e-4, "{kernel:?} at {squared}: {slope} {weight}");
                assert!((0.0..=1.0).contains(&weight));
            }
        }
        let hard = Kernel::Truncated { width: 2.0, convexity: f64::INFINITY };
        assert_eq!(
            [3.9, 4.1, 1e9].map(|squared| hard.evaluate(squared)),
            [(3.9, 1.0), (4.0, 0.0), (4.0, 0.0)]
        );
    }
}

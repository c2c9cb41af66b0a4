//! The strength of damping and its changes: Nielsen's rule, from zero.
//!
//! K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear least squares problems", 2004, section 3.2.

/// Damping after the first failure, as a share of the diagonal. It is small, since most failures near a minimum need little
/// damping, and the growth factor doubles with each further failure.
pub(crate) const FIRST_DAMPING: f64 = 1e-5;
/// Damping beyond which a step is below rounding.
pub(crate) const LARGEST_DAMPING: f64 = 1e16;
/// Damping below which the next step is undamped again.
const SMALLEST_DAMPING: f64 = 1e-8;

/// The damping and how fast it grows.
pub(super) struct Damping {
    pub(super) value: f64,
    growth: f64,
    largest: f64,
}

impl Damping {
    /// Starts without damping, and never exceeds this.
    pub(super) fn up_to(largest: f64) -> Self {
        Self { value: 0.0, growth: 4.0, largest }
    }

    /// Increases damping; false if it exceeds the limit.
    pub(super) fn raise(&mut self) -> bool {
        self.value = if self.value == 0.0 { FIRST_DAMPING } else { self.value * self.growth };
        self.growth *= 2.0;
        self.value <= self.largest
    }

    /// Reduces damping after a step with this ratio of gain to promise. Nielsen's rule.
    pub(super) fn lower(&mut self, gain: f64) {
        self.value *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(0.1);
        self.growth = 4.0;
        if self.value < SMALLEST_DAMPING {
            self.value = 0.0;
        }
    }
}

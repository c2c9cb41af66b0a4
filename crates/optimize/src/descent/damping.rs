//! The strength of damping and its changes: Nielsen's rule, from zero.
//!
//! K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear least squares problems", 2004, section 3.2.

/// Damping of a singular matrix at its first failure, as a share of the diagonal.
pub(crate) const FIRST_DAMPING: f64 = 1e-5;
/// Damping beyond which a step is below rounding.
pub(crate) const LARGEST_DAMPING: f64 = 1e16;
/// The next step is undamped again if damping would change the last one by less than this share.
const NEGLIGIBLE: f64 = 1e-2;

/// The damping and how fast it grows.
pub(super) struct Damping {
    pub(super) value: f64,
    growth: f64,
    largest: f64,
}

/// The first damping after an undamped step of this stiffness that kept this share of its promise (less than nothing, if the cost
/// rose).
///
/// Along the step, the cost is `f - 2 p a + p a^2 + k a^4` for a share `a` of it with promise `p`: what the model leaves out grows with the
/// fourth power where residuals bend. The full step gives `k`, and the minimum is near `a^3 = p / (2 k)`. Damping by `stiffness (1 / a - 1)`
/// makes the step that long.
pub(super) fn first_damping(stiffness: f64, gain: f64) -> f64 {
    let share = if gain.is_finite() { (0.5 / (1.0 - gain).max(1.0)).cbrt() } else { LEAST_SHARE };
    stiffness * (1.0 / share.max(LEAST_SHARE) - 1.0).max(1.0)
}

/// The first damping shortens a step at most to this share.
const LEAST_SHARE: f64 = 1e-3;

impl Damping {
    /// Starts without damping, and never exceeds this.
    pub(super) fn up_to(largest: f64) -> Self {
        Self { value: 0.0, growth: 4.0, largest }
    }

    /// Increases damping, from zero to `first`; false if it exceeds the limit.
    pub(super) fn raise(&mut self, first: f64) -> bool {
        self.value = if self.value == 0.0 { first } else { self.value * self.growth };
        self.growth *= 2.0;
        self.value <= self.largest
    }

    /// Sets damping after a step that was taken all the same, as far as the limit allows.
    pub(super) fn start(&mut self, value: f64) {
        self.value = value.min(self.largest);
    }

    /// Reduces damping after a step of this stiffness with this ratio of gain to promise. Nielsen's rule.
    pub(super) fn lower(&mut self, gain: f64, stiffness: f64) {
        self.value *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(0.1);
        self.growth = 4.0;
        if self.value < NEGLIGIBLE * stiffness {
            self.value = 0.0;
        }
    }
}

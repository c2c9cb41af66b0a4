//! The options of the solver.

use crate::model::kernel::Kernel;

/// Where to start from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Initialisation {
    /// The given poses.
    Given,
    /// Odometry composed from the first node, its chains joined over landmark edges.
    SpanningTree,
    /// Rotations by the chordal relaxation, then translations.
    Chordal,
    /// The relaxation, then every other start that costs less than its result. With robust kernels, the start with the lowest
    /// cost comes first. The lowest result is kept. In the plane, given poses that miss their edges by little more than noise and lie in the
    /// right basin of rotations replace the relaxation.
    #[default]
    Best,
}

/// How steps are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Gauss-Newton steps, damped once one fails.
    #[default]
    LevenbergMarquardt,
    /// Gauss-Newton steps; the first that fails ends the iteration.
    GaussNewton,
    /// Powell's dogleg within a trust region.
    Dogleg,
}

/// The robust cost of landmark edges at the end of graduation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Graduated {
    /// `min(s, c^2)`: an edge is in or out. Parameter c in standard deviations.
    TruncatedLeastSquares(f64),
    /// `s c^2 / (c^2 + s)`. Parameter c in standard deviations.
    GemanMcClure(f64),
}

impl Graduated {
    /// The kernel of the last round.
    pub fn kernel(self) -> Kernel {
        match self {
            Self::TruncatedLeastSquares(width) => Kernel::Truncated { width, convexity: f64::INFINITY },
            Self::GemanMcClure(width) => Kernel::GemanMcClure(width),
        }
    }

    /// Parameter c, standard deviations.
    pub fn width(self) -> f64 {
        match self {
            Self::TruncatedLeastSquares(width) | Self::GemanMcClure(width) => width,
        }
    }
}

/// Settings of [`optimize`](crate::optimize).
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Where to start from.
    pub initialisation: Initialisation,
    /// How steps are chosen.
    pub method: Method,
    /// Maximum number of steps tried per connected component and start, rejected ones included. The search for a lower minimum after a
    /// hard descent is left out where it is 20 or less.
    pub max_iterations: usize,
    /// Converged when a full Gauss-Newton step promises to lower the cost by less than this share of it. With zero, and a
    /// method other than the dogleg, steps continue even where their gain is too small to be seen in the cost, until they no
    /// longer shrink. Poses that the edges hold weakly are then as exact as the gradient, some digits more than the cost can
    /// show.
    pub cost_tolerance: f64,
    /// Converged when no component of a full Gauss-Newton step exceeds this: shares of the median measured distance, and radians.
    pub step_tolerance: f64,
    /// Converged when the residuals are orthogonal to all derivatives: when no `|g_k| / sqrt(H_kk cost)`, the cosine of the angle
    /// between the whitened residuals and their derivative by a component of a pose, exceeds this. Neither the unit of length
    /// nor the scale of the information changes it.
    pub gradient_tolerance: f64,
    /// Graduated non-convexity over the landmark edges, whose own kernels it replaces.
    pub graduated: Option<Graduated>,
}

/// A gain below this share of the cost is lost in the rounding of the sum.
const HIDDEN: f64 = 1e-12;

impl Options {
    /// Whether to continue by the gradient alone, since the step's promise is too small to be seen in the cost. The cost is
    /// at least that of a graph without noise.
    pub(crate) fn is_hidden(&self, promised: f64, cost: f64) -> bool {
        self.cost_tolerance == 0.0 && promised <= HIDDEN * cost
    }

    /// The iteration ends at a step that promises less than this. The cost is at least that of a graph without noise.
    pub(crate) fn promise_tolerance(&self, cost: f64) -> f64 {
        // Rounding of the sum hides any smaller gain.
        self.cost_tolerance.max(4.0 * f64::EPSILON) * cost
    }
}

impl Default for Options {
    /// Best start, Levenberg-Marquardt, 200 iterations, tolerances 1e-10 (cost), 1e-10 (step), 1e-12 (gradient); no
    /// graduation.
    fn default() -> Self {
        Self {
            initialisation: Initialisation::Best,
            method: Method::LevenbergMarquardt,
            max_iterations: 200,
            cost_tolerance: 1e-10,
            step_tolerance: 1e-10,
            gradient_tolerance: 1e-12,
            graduated: None,
        }
    }
}

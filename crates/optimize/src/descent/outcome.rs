//! How an iteration ended, and the measures of its last step.

use crate::options::Options;

/// Why iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// No edges, or every node is held.
    NothingToDo,
    /// A full step would lower the cost by less than the tolerance.
    Cost,
    /// A full step is shorter than the tolerance.
    Step,
    /// The gradient is below the tolerance.
    Gradient,
    /// The iteration limit was reached first.
    IterationLimit,
    /// No damping gave a step that lowers the cost: only rounding errors remain, or the cost is not finite near the poses.
    Stalled,
}

impl Termination {
    /// Whether a tolerance was met.
    pub fn converged(self) -> bool {
        matches!(self, Self::NothingToDo | Self::Cost | Self::Step | Self::Gradient)
    }

    /// Name for reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::NothingToDo => "nothing to do",
            Self::Cost => "cost",
            Self::Step => "step",
            Self::Gradient => "gradient",
            Self::IterationLimit => "iteration limit",
            Self::Stalled => "stalled",
        }
    }
}

/// How an iteration ended.
pub(crate) struct Outcome {
    /// The cost before the first step.
    pub(crate) initial: f64,
    pub(crate) cost: f64,
    pub(crate) iterations: usize,
    pub(crate) rejected: usize,
    /// Number of factorisations for the steps tried.
    pub(crate) factorizations: usize,
    pub(crate) termination: Termination,
    /// The largest cosine of the angle between residuals and a derivative.
    pub(crate) gradient: f64,
    /// The last step tried.
    pub(crate) last: Step,
    pub(crate) undetermined: Option<(usize, usize)>,
}

impl Outcome {
    /// The outcome before the first step.
    pub(crate) fn new(cost: f64) -> Self {
        Self {
            initial: cost,
            cost,
            iterations: 0,
            rejected: 0,
            factorizations: 0,
            termination: Termination::IterationLimit,
            gradient: 0.0,
            last: Step { promised: f64::NAN, largest: f64::NAN },
            undetermined: None,
        }
    }

    /// The same outcome with the steps of an earlier descent counted.
    pub(crate) fn after(mut self, earlier: &Self) -> Self {
        self.iterations += earlier.iterations;
        self.rejected += earlier.rejected;
        self.factorizations += earlier.factorizations;
        self
    }
}

/// What the quadratic model says about a step.
#[derive(Clone, Copy)]
pub(crate) struct Step {
    /// The decrease of a quadratic cost by this step: `-g^T d + damping d^T D d`.
    pub(crate) promised: f64,
    /// Its largest component: shares of the graph's length, and radians.
    pub(crate) largest: f64,
}

impl Step {
    /// The tolerance that the step meets at this cost, which is at least that of a graph without noise. `shrinks` is true for
    /// a full step that is shorter than the one before.
    pub(crate) fn met(&self, cost: f64, shrinks: bool, options: &Options) -> Option<Termination> {
        let goes_on = shrinks && options.is_hidden(self.promised, cost);
        if self.promised <= options.promise_tolerance(cost) && !goes_on {
            Some(Termination::Cost)
        } else if self.largest <= options.step_tolerance {
            Some(Termination::Step)
        } else {
            None
        }
    }
}

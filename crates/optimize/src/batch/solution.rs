//! The result of an optimisation, and its report.

use crate::descent::outcome::{Outcome, Termination};
use crate::descent::phases::Phases;

/// The start of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The given poses.
    Given,
    /// The spanning tree.
    SpanningTree,
    /// The chordal relaxation.
    Chordal,
    /// SE-Sync's cost in more dimensions and with weak translations, then continuation to the graph's own.
    Lifted,
}

impl Start {
    /// Name for reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::SpanningTree => "spanning tree",
            Self::Chordal => "chordal",
            Self::Lifted => "lifted",
        }
    }
}

/// How one connected component was solved.
#[derive(Clone, Debug)]
pub struct ComponentReport {
    /// Its first held node; its first node if none is held.
    pub gauge: usize,
    /// Number of nodes that were to be held; if it and `priors` are zero, the component's first node is held.
    pub held: usize,
    /// Number of priors.
    pub priors: usize,
    /// Whether the priors leave the component free to turn and no node is held: see
    /// [`Problem::with_priors`](crate::Problem::with_priors).
    pub free: bool,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of edges.
    pub edges: usize,
    /// Cost at the given poses (kernels applied).
    pub cost_given: f64,
    /// Cost at the start that was chosen.
    pub cost_start: f64,
    /// Final cost.
    pub cost: f64,
    /// Start that was chosen.
    pub start: Start,
    /// Steps tried, over all starts.
    pub iterations: usize,
    /// Steps tried that did not lower the cost.
    pub rejected: usize,
    /// Factorisations for these steps; steps near the minimum reuse an earlier one.
    pub factorizations: usize,
    /// Why iteration ended.
    pub termination: Termination,
    /// Largest cosine of the angle between residuals and a derivative at the end: see
    /// [`Options::gradient_tolerance`](crate::Options::gradient_tolerance).
    pub gradient: f64,
    /// The decrease of the cost that the last step promised; NaN if none was tried.
    pub last_promise: f64,
    /// Largest component of the last step, shares of the median measured distance and radians; NaN if none was tried.
    pub last_step: f64,
    /// Node and component that the edges leave undetermined, if damping had to make the equations solvable.
    pub undetermined: Option<(usize, usize)>,
    /// Blocks of the factor.
    pub factor_blocks: usize,
    /// Floating-point operations of one numeric factorisation.
    pub flops: f64,
    /// The time by phases.
    pub phases: Phases,
}

impl ComponentReport {
    /// The report of a component that needs no optimisation.
    pub(crate) fn untouched(nodes: usize, edges: usize, cost: f64) -> Self {
        Self {
            gauge: 0,
            held: 0,
            priors: 0,
            free: false,
            nodes,
            edges,
            cost_given: cost,
            cost_start: cost,
            cost,
            start: Start::Given,
            iterations: 0,
            rejected: 0,
            factorizations: 0,
            termination: Termination::NothingToDo,
            gradient: 0.0,
            last_promise: f64::NAN,
            last_step: f64::NAN,
            undetermined: None,
            factor_blocks: 0,
            flops: 0.0,
            phases: Phases::default(),
        }
    }

    /// Adds the steps of a descent.
    pub(crate) fn count(&mut self, outcome: &Outcome) {
        self.iterations += outcome.iterations;
        self.rejected += outcome.rejected;
        self.factorizations += outcome.factorizations;
    }

    /// Stores the result of one start; steps are counted over all starts.
    pub(crate) fn adopt(&mut self, start: Start, cost_start: f64, outcome: &Outcome) {
        self.start = start;
        self.cost_start = cost_start;
        self.cost = outcome.cost;
        self.termination = outcome.termination;
        self.gradient = outcome.gradient;
        self.last_promise = outcome.last.promised;
        self.last_step = outcome.last.largest;
        self.undetermined = outcome.undetermined;
    }
}

impl<G> Solution<G> {
    /// The weights of edges, then of priors, as [`Marginals::new`](crate::Marginals::new) takes them.
    pub fn all_weights(&self) -> Vec<f64> {
        [self.weights.as_slice(), self.prior_weights.as_slice()].concat()
    }
}

/// Result of [`optimize`](crate::optimize).
#[derive(Clone, Debug)]
pub struct Solution<G> {
    /// Optimised poses, in the order of the nodes.
    pub poses: Vec<G>,
    /// Sum of `e^T Omega e` over edges and priors at the given poses.
    pub chi_square_given: f64,
    /// Sum of `e^T Omega e` at the chosen starts.
    pub chi_square_initial: f64,
    /// Sum of `e^T Omega e` at the result.
    pub chi_square: f64,
    /// Sum of `rho(e^T Omega e)` at the result; equals `chi_square` without kernels.
    pub cost: f64,
    /// Steps tried, summed over the components.
    pub iterations: usize,
    /// Whether every component met a tolerance.
    pub converged: bool,
    /// Weight `rho'` of every edge at the result: 1 without kernel.
    pub weights: Vec<f64>,
    /// Weight `rho'` of every prior at the result.
    pub prior_weights: Vec<f64>,
    /// The connected components, in the order of their first nodes.
    pub components: Vec<ComponentReport>,
}

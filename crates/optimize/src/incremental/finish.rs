//! Full solutions: the closing one, and fresh starts.

use nalgebra::SVector;

use super::{FinishReport, IncrementalSolver};
use crate::problem::Problem;
use crate::{Initialisation, Options, PoseGroup, optimize};

/// Most full relinearisations in [`IncrementalSolver::finish`].
const MOST_ITERATIONS: usize = 100;
/// Components of a step that end [`IncrementalSolver::finish`], metres and radians.
const STEP_TOLERANCE: f64 = 1e-10;
/// Steps below this that no longer shrink are rounding.
const ROUNDING: f64 = 1e-7;
/// Share of the cost by which a fresh start must be better to be taken.
const BETTER: f64 = 1e-9;

impl<G: PoseGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// Relinearises everything until the estimate stands still: it is then that of a fresh solution of the edges that are
    /// there.
    ///
    /// If edges were taken back since the last time, or a step was too long to be trusted, or full steps do not converge,
    /// the batch solver starts anew (see [`restart`](Self::restart)), so that a false edge leaves no trace even where it
    /// had folded the map into another basin.
    pub fn finish(&mut self) -> FinishReport {
        let cost_before = self.cost();
        let mut report = FinishReport {
            iterations: 0,
            converged: false,
            restarted: false,
            cost_before,
            cost: cost_before,
        };
        if self.strained {
            report.restarted = self.restart();
        }
        self.iterate(&mut report);
        if !report.converged && self.restart() {
            report.restarted = true;
            self.iterate(&mut report);
        }
        self.strained = !report.converged;
        report.cost = self.cost();
        report
    }

    /// Gauss-Newton until it stands still, or goes uphill.
    fn iterate(&mut self, report: &mut FinishReport) {
        let (mut cost, mut last_step) = (self.cost(), f64::INFINITY);
        for _ in 0..MOST_ITERATIONS {
            report.iterations += 1;
            let (step, _) = self.relinearise_all();
            let next = self.cost();
            if !(next <= cost * (1.0 + BETTER) + f64::EPSILON) {
                self.go_to(self.estimate.points.clone());
                return;
            }
            report.converged = step <= STEP_TOLERANCE || (step <= ROUNDING && step > 0.5 * last_step);
            if report.converged {
                return;
            }
            (cost, last_step) = (next, step);
        }
    }

    /// Solves by the batch solver, from its best start, and takes the result if it costs less than the estimate. Says
    /// whether it did. Takes as long as a batch solution.
    pub fn restart(&mut self) -> bool {
        let estimates = self.estimates();
        let cost = self.cost_at(&estimates);
        let edges = self.edges.list().map(|(_, edge)| *edge).collect();
        let problem = Problem::from_checked(estimates, edges, self.fixed.clone());
        let solution =
            optimize(&problem, &Options { initialisation: Initialisation::Best, ..Options::default() });
        let is_better = solution.cost < cost * (1.0 - BETTER) || !cost.is_finite();
        if is_better {
            self.go_to(solution.poses);
            self.relinearise_all();
        }
        is_better
    }

    /// Makes these the estimates and the points of linearisation.
    fn go_to(&mut self, poses: Vec<G>) {
        for (node, pose) in poses.into_iter().enumerate() {
            self.estimate.reset(node, pose);
            self.checked[node] = SVector::zeros();
        }
    }
}

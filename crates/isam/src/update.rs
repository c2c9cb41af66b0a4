//! Updates: what is relinearised and solved when.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::SVector;
use posecut_optimize::PoseGroup;
use posecut_optimize::model::translations;

use crate::{IncrementalSolver, UpdateReport};

/// A rotation beyond which a Gauss-Newton step is not trusted without a look at the cost, radians. Translations beyond all measured
/// distances together are not, either.
const LONG_ROTATION: f64 = 0.5;
/// Share of the cost if edges had measured nothing, in which linearisation errors are compared to this rather than to the cost:
/// a graph without noise needs no more.
const LEAST_COST: f64 = 1e-8;

/// Steps of the batch solver that restarts may take for each update, on average over the session. Restarts that are of use are
/// far rarer.
const STEPS_PER_UPDATE: usize = 2;

/// When to solve anew inside of an update. A restart takes as long as a batch solution: one that did not help, or did not
/// converge and so will not hold, makes the next ones rarer, and all of them together have a budget.
#[derive(Debug, Default)]
pub(crate) struct Restarts {
    not_before: usize,
    pause: usize,
    /// Whether the last long step was not taken, and could not be answered by a restart.
    stuck: bool,
    /// Poses times steps: what has been spent, and what may be.
    spent: usize,
    allowance: usize,
}

impl Restarts {
    fn is_due(&self, updates: usize) -> bool {
        updates >= self.not_before && self.spent <= self.allowance
    }
}

impl<G: PoseGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// Brings the estimate up to date with all changes.
    ///
    /// Gauss-Newton steps that turn a pose by more than half a radian and raise the cost are not taken: the batch solver
    /// starts anew then, and the report says so. Where such restarts do not help or do not converge they become rare; poses then
    /// stay where they are.
    pub fn update(&mut self) -> UpdateReport {
        let mut report = UpdateReport { splits: std::mem::take(&mut self.splits), ..UpdateReport::default() };
        let due = self.updates.is_multiple_of(self.options.relinearise_every);
        // To relinearise everything again would lead uphill again, until a restart finds a better start.
        let due = due && (!self.restarts.stuck || self.restarts.is_due(self.updates + 1));
        self.updates += 1;
        self.restarts.allowance += STEPS_PER_UPDATE * self.poses();
        if due {
            self.check(&mut report);
        }
        self.solve(&mut report, self.options.propagate);
        let mut is_uphill = self.is_uphill();
        if due {
            for _ in 1..self.options.iterations {
                // Points of linearisation do not follow a step that nothing can answer.
                let unanswered = is_uphill && !self.restarts.is_due(self.updates);
                if unanswered || !self.check(&mut report) {
                    break;
                }
                self.solve(&mut report, self.options.propagate);
                is_uphill = self.is_uphill();
            }
        }
        let is_due = self.restarts.is_due(self.updates);
        self.restarts.stuck = is_uphill && !is_due;
        if self.restarts.stuck {
            self.go_to(self.estimate.points.clone());
        } else if is_uphill {
            report.restarted = true;
            let fresh = self.fresh_start();
            self.restarts.spent += fresh.steps * self.poses();
            let helped = fresh.is_better && fresh.converged;
            self.restarts.pause = if helped { 0 } else { (2 * self.restarts.pause).max(8) };
            self.restarts.not_before = self.updates + self.restarts.pause;
        }
        self.new_ends.clear();
        report.undetermined.sort_unstable();
        report.undetermined.dedup();
        report
    }

    /// Whether the last solution was a step too long to trust, and led uphill.
    fn is_uphill(&mut self) -> bool {
        self.strained |= self.long_step;
        self.long_step && !(self.cost() <= self.cost_at(&self.estimate.points))
    }

    /// Looks at the edges of variables that have moved, and, if linearisation errors have grown to more than is allowed,
    /// moves the points of linearisation of all variables beyond the thresholds to the estimate. Says
    /// whether it did.
    fn check(&mut self, report: &mut UpdateReport) -> bool {
        self.edges.begin_check();
        for node in std::mem::take(&mut self.moved) {
            if !self.fixed[node] && self.is_beyond(&(self.estimate.deltas[node] - self.checked[node])) {
                if self.checked[node].amax() == 0.0 {
                    self.candidates.push(node);
                }
                self.checked[node] = self.estimate.deltas[node];
                self.edges.check(node, &self.estimate);
            }
        }
        let (error, cost) = self.edges.error_and_cost(LEAST_COST);
        if error < self.options.linearisation_error * cost && !self.long_step {
            return false;
        }
        let before = report.relinearised;
        for node in std::mem::take(&mut self.candidates) {
            if !self.fixed[node] && self.is_beyond(&self.estimate.deltas[node]) {
                self.relinearise(node);
                report.relinearised += 1;
            } else {
                self.checked[node] = SVector::zeros();
            }
        }
        report.relinearised > before
    }

    /// Whether a component exceeds its threshold.
    #[inline(always)]
    fn is_beyond(&self, value: &SVector<f64, DOF>) -> bool {
        // Written so that NaN is beyond.
        let beyond =
            |(component, value): (usize, &f64)| !(value.abs() <= self.options.relinearise(component, DOF));
        value.iter().enumerate().any(beyond)
    }

    /// Eliminates again what was touched, and solves.
    fn solve(&mut self, report: &mut UpdateReport, threshold: f64) {
        self.long_step = false;
        report.linearised += self.edges.linearise(&self.estimate.points);
        let (made, orphans) = self.rebuild_top(report);
        self.elimination.eliminate(&mut self.tree, &made, &self.edges, &self.estimate.deltas);
        for &clique in &made {
            report.undetermined.extend_from_slice(&self.tree.clique(clique).undetermined);
        }
        self.substitute(&made, orphans, threshold, report);
    }

    /// Notes a new linear update of a variable: whether subtrees below have to follow, and whether it has moved far.
    #[inline(always)]
    pub(crate) fn take_value(&mut self, node: usize, value: SVector<f64, DOF>, threshold: f64) {
        self.estimate.deltas[node] = value;
        if (value - self.propagated[node]).amax() > threshold {
            self.propagated[node] = value;
            self.changed[node] = self.solutions;
        }
        if self.is_beyond(&(value - self.checked[node])) {
            self.moved.push(node);
            let (along, about) = value.as_slice().split_at(translations(DOF));
            self.long_step |= about.iter().any(|angle| !(angle.abs() <= LONG_ROTATION))
                || along.iter().any(|length| !(length.abs() <= self.reach));
        }
    }

    /// Relinearises every variable and solves for all. Returns the largest component of the linear update that is left:
    /// the length of the next Gauss-Newton step.
    pub fn relinearise_all(&mut self) -> (f64, UpdateReport) {
        let mut report = UpdateReport { splits: std::mem::take(&mut self.splits), ..UpdateReport::default() };
        for node in 0..self.poses() {
            if !self.fixed[node] {
                self.relinearise(node);
                report.relinearised += 1;
            }
        }
        self.moved.clear();
        self.candidates.clear();
        self.solve(&mut report, 0.0);
        let step = self.estimate.deltas.iter().map(SVector::amax).fold(0.0, f64::max);
        (step, report)
    }
}

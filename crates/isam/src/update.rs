//! Updates: when variables are relinearised and solved.

use nalgebra::SVector;

use crate::substitution::Below;
use crate::{IncrementalGroup, IncrementalSolver, UpdateReport};

/// Linearisation errors are compared with the cost, but at least with this share of the cost that residuals as large as the
/// measurements would have: a graph without noise needs no more.
const LEAST_COST: f64 = 1e-8;

impl<G: IncrementalGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// Brings the estimate up to date with all changes.
    ///
    /// A Gauss-Newton step that turns a pose by more than half a radian and raises the cost is refused. The batch solver then
    /// starts anew, and the report says so. Where restarts do not help or do not converge, they become rare; between them,
    /// poses keep their values.
    pub fn update(&mut self) -> UpdateReport {
        G::update(self)
    }

    pub(crate) fn update_here(&mut self) -> UpdateReport {
        let mut report = UpdateReport { splits: self.gauges.take_splits(), ..UpdateReport::default() };
        let due = self.updates.is_multiple_of(self.options.relinearise_every);
        // Another relinearisation would lead uphill again, until a restart finds a better start.
        let due = due && (!self.restarts.stuck || self.restarts.is_due(self.updates + 1));
        self.updates += 1;
        self.restarts.allow(self.gauges.live().len());
        if due {
            self.check(&mut report);
        }
        self.solve(&mut report, self.options.propagate);
        let mut is_uphill = self.is_uphill();
        if due {
            for _ in 1..self.options.iterations {
                // Points of linearisation do not follow a long step uphill if no restart is due.
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
            self.go_to_points();
        } else if is_uphill {
            report.restarted = true;
            let fresh = self.fresh_start();
            self.restarts.count(fresh, self.updates, self.gauges.live().len());
        }
        self.top.end_update();
        report.marginalised = self.marginalise_old();
        report.undetermined.sort_unstable();
        report.undetermined.dedup();
        report
    }

    /// Whether the last solution was a step too long to be trusted and led uphill.
    fn is_uphill(&mut self) -> bool {
        self.restarts.strained |= self.movement.long_step;
        self.movement.long_step && !(self.cost() <= self.cost_at(|node| self.estimate.points[node]))
    }

    /// Checks the edges of variables that have moved. If linearisation errors exceed the limit or the last step was long,
    /// relinearises all variables beyond the thresholds at the estimate. Returns whether it relinearised any.
    fn check(&mut self, report: &mut UpdateReport) -> bool {
        self.movement.look(&self.gauges.fixed, &self.estimate, &mut self.edges);
        let (error, cost) = self.edges.error_and_cost(LEAST_COST);
        if error < self.options.linearisation_error * cost && !self.movement.long_step {
            return false;
        }
        let before = report.relinearised;
        for node in self.movement.take_candidates() {
            if !self.gauges.fixed[node] && self.movement.is_beyond(&self.estimate.deltas[node]) {
                self.relinearise(node);
                report.relinearised += 1;
            } else {
                self.movement.reset(node);
            }
        }
        report.relinearised > before
    }

    /// Eliminates the touched cliques again, and solves.
    fn solve(&mut self, report: &mut UpdateReport, threshold: f64) {
        self.movement.long_step = false;
        report.linearised += self.edges.linearise(&self.estimate.points);
        self.priors.refresh(&self.estimate.points, &self.gauges.fixed, &mut self.tree);
        let loose = self.priors.loose(&self.tree);
        let (made, orphans) =
            self.top.rebuild(&mut self.tree, &self.edges, loose, &self.gauges.fixed, report);
        self.elimination.eliminate(&mut self.tree, &made, &self.edges, &self.estimate.deltas);
        for &clique in &made {
            report.undetermined.extend_from_slice(&self.tree.clique(clique).undetermined);
        }
        let Self { substitution, tree, estimate, movement, .. } = self;
        substitution.solve(Below { made: &made, orphans, threshold }, tree, estimate, movement, report);
    }

    /// Relinearises every variable and solves for all. Returns the largest component of the resulting linear update: the
    /// length of the next Gauss-Newton step.
    pub fn relinearise_all(&mut self) -> (f64, UpdateReport) {
        G::relinearise_all(self)
    }

    pub(crate) fn relinearise_all_here(&mut self) -> (f64, UpdateReport) {
        let mut report = UpdateReport { splits: self.gauges.take_splits(), ..UpdateReport::default() };
        for node in self.gauges.live().to_vec() {
            if !self.gauges.fixed[node] {
                self.relinearise(node);
                report.relinearised += 1;
            }
        }
        self.movement.clear();
        self.solve(&mut report, 0.0);
        let step = self.estimate.deltas.iter().map(SVector::amax).fold(0.0, f64::max);
        (step, report)
    }
}

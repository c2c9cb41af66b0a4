//! When an update may restart the batch solver.

use crate::finish::FreshStart;

/// Budget of restarts: steps of the batch solver per update, on average over the session. Useful restarts are far rarer.
const STEPS_PER_UPDATE: usize = 2;

/// When an update may restart the batch solver.
///
/// A restart takes as long as a batch solution. One that does not help, or does not converge and so will not last, makes the
/// next ones rarer, and all restarts share a budget.
#[derive(Debug, Default)]
pub(crate) struct Restarts {
    not_before: usize,
    pause: usize,
    /// Whether the last long step was refused and no restart could replace it.
    pub(crate) stuck: bool,
    /// Whether the estimate may be in a wrong basin: a step was too long to be trusted, or an edge was removed.
    pub(crate) strained: bool,
    /// What restarts have spent and may spend, in poses times steps.
    spent: usize,
    allowance: usize,
}

impl Restarts {
    /// Adds the share of an update of so many poses to the budget.
    pub(crate) fn allow(&mut self, poses: usize) {
        self.allowance += STEPS_PER_UPDATE * poses;
    }

    /// Whether an update may restart.
    pub(crate) fn is_due(&self, updates: usize) -> bool {
        updates >= self.not_before && self.spent <= self.allowance
    }

    /// Counts a restart of this update, over so many poses.
    pub(crate) fn count(&mut self, fresh: FreshStart, updates: usize, poses: usize) {
        self.spent += fresh.steps * poses;
        let helped = fresh.is_better && fresh.converged;
        self.pause = if helped { 0 } else { (2 * self.pause).max(8) };
        self.not_before = updates + self.pause;
    }
}

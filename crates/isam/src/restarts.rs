//! When to solve anew inside of an update.

use crate::finish::FreshStart;

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
    pub(crate) stuck: bool,
    /// Whether the estimate may be in a wrong basin: a step was too long to trust, or an edge was taken back.
    pub(crate) strained: bool,
    /// Poses times steps: what has been spent, and what may be.
    spent: usize,
    allowance: usize,
}

impl Restarts {
    /// Adds to the budget what an update of so many poses allows.
    pub(crate) fn allow(&mut self, poses: usize) {
        self.allowance += STEPS_PER_UPDATE * poses;
    }

    /// Whether an update may restart.
    pub(crate) fn is_due(&self, updates: usize) -> bool {
        updates >= self.not_before && self.spent <= self.allowance
    }

    /// Counts a restart in this update, over so many poses.
    pub(crate) fn count(&mut self, fresh: FreshStart, updates: usize, poses: usize) {
        self.spent += fresh.steps * poses;
        let helped = fresh.is_better && fresh.converged;
        self.pause = if helped { 0 } else { (2 * self.pause).max(8) };
        self.not_before = updates + self.pause;
    }
}

//! The time of a solution, by phases.

use std::ops::AddAssign;
use std::time::Instant;

/// Wall-clock seconds of the phases of [`optimize`](crate::optimize). Only they differ from run to run; the rest of the
/// result is always the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phases {
    /// Ordering and symbolic factorisation.
    pub analysis: f64,
    /// Computing the proposed starts and their costs.
    pub start: f64,
    /// Costs, gradients and normal equations of the edges, and moves of the poses.
    pub linearisation: f64,
    /// Numeric factorisations.
    pub factorisation: f64,
    /// Triangular solves.
    pub substitution: f64,
    /// Total time, including time outside these phases.
    pub total: f64,
}

impl AddAssign for Phases {
    fn add_assign(&mut self, other: Self) {
        self.analysis += other.analysis;
        self.start += other.start;
        self.linearisation += other.linearisation;
        self.factorisation += other.factorisation;
        self.substitution += other.substitution;
        self.total += other.total;
    }
}

/// Runs `work` and adds its time to the seconds of a phase.
pub(crate) fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds += start.elapsed().as_secs_f64();
    result
}

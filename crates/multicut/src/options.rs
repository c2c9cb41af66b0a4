//! Options of the solver.

use std::time::Duration;

use serde::Serialize;

/// The algorithm for the kernels that reductions leave.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Solver {
    /// Lower bounds and branching until the optimum is proved
    #[default]
    Exact,
    /// Greedy additive edge contraction, then Kernighan-Lin with joins
    Klj,
    /// Greedy additive edge contraction
    Gaec,
}

/// Options of [`solve`](crate::solve()).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Algorithm for the kernels.
    pub solver: Solver,
    /// Time after which the best solution and bound so far are returned. If it is reached, the result depends on the machine;
    /// if the proof completes earlier, it does not.
    pub time_limit: Option<Duration>,
    /// Work after which the best solution and bound so far are returned, with the same result on every machine. One unit is
    /// about one visited edge, and 10^8 units take seconds.
    pub work_limit: Option<u64>,
    /// Seed of the local search, which improves solutions that are not proved optimal.
    pub seed: u64,
    /// Whether to record a [`Certificate`](crate::Certificate) of the lower bound.
    pub certificate: bool,
}

impl Default for Options {
    /// Exact, within 60 seconds.
    fn default() -> Self {
        Self {
            solver: Solver::Exact,
            time_limit: Some(Duration::from_mins(1)),
            work_limit: None,
            seed: 0,
            certificate: false,
        }
    }
}

//! The solver's options on the command line, and the report on a solution.

use std::time::Duration;

use posecut_stage::{Context, Doubt};
use serde::Serialize;

use crate::{Options, Solution, Solver};

/// The algorithm and its limits.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct SolverOptions {
    /// Choose the algorithm for the graph that remains after reductions
    #[arg(long, value_enum, default_value_t = Solver::Exact)]
    pub solver: Solver,

    /// Stop after this many seconds, and return the best solution so far with its gap
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    pub time_limit: f64,

    /// Stop after this many units of work, with the same result on every machine.
    ///
    /// One unit is about one visited edge; 1e8 units take some seconds. The time limit still applies, so raise it too.
    #[arg(long, value_name = "UNITS")]
    pub work_limit: Option<u64>,
}

impl SolverOptions {
    /// The solver's options, from those of the command line.
    pub fn options(&self, certificate: bool) -> anyhow::Result<Options> {
        let time_limit = Duration::try_from_secs_f64(self.time_limit).map_err(|_| {
            anyhow::anyhow!(
                "--time-limit is {}, but must be zero or a positive number of seconds",
                self.time_limit
            )
        })?;
        Ok(Options {
            solver: self.solver,
            time_limit: Some(time_limit),
            work_limit: self.work_limit,
            certificate,
            ..Options::default()
        })
    }
}

/// Adds a solution to the statistics, and raises a doubt if the proof is not complete.
pub fn note(solution: &Solution, solver: Solver, context: &mut Context) {
    if !solution.optimal {
        let remedy = match solver {
            Solver::Exact => "raise --time-limit or --work-limit",
            _ => "use --solver exact to search for a proof",
        };
        context.doubt(
            Doubt::SearchLimit,
            format!(
                "the multicut is not proved optimal: objective {}, lower bound {}, gap {}; {remedy}",
                solution.objective,
                solution.lower_bound,
                solution.gap()
            ),
        );
    }
    let statistics = &mut context.statistics;
    statistics.note("objective", solution.objective);
    statistics.note("lower_bound", solution.lower_bound);
    statistics.note("gap", solution.gap());
    statistics.note("optimal", solution.optimal);
    statistics.note("kernel_nodes", solution.kernel_nodes);
    statistics.note("kernel_edges", solution.kernel_edges);
    statistics.note("largest_kernel_edges", solution.largest_kernel.1);
    statistics.note("work", solution.work);
}

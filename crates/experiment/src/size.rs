//! Limits the size of a plan. The size is counted before the plan is made.

use anyhow::bail;

use crate::Grid;

/// The largest number of results of one plan. A plan needs about 15 kB of memory for each.
const LARGEST: u64 = 100_000;

/// Results counted so far.
#[derive(Default)]
pub(crate) struct Size(u64);

impl Size {
    /// Adds the results of one block of a grid for one session or graph, and refuses more than a plan can hold.
    pub(crate) fn add(&mut self, grid: &Grid, seeds: u64, methods: usize) -> anyhow::Result<()> {
        let counted = |count: usize| u64::try_from(count).unwrap_or(u64::MAX);
        let points =
            grid.axes.values().fold(1, |points: u64, values| points.saturating_mul(counted(values.len())));
        // The reference runs even if there are no methods.
        let results = [points, counted(methods.max(1))].into_iter().fold(seeds, u64::saturating_mul);
        self.0 = self.0.saturating_add(results);
        if self.0 > LARGEST {
            bail!(
                "{points} points of its grid, {seeds} seeds and {methods} methods for each session or graph are more than the {LARGEST} results that a plan can have; use fewer seeds, or divide the experiment"
            );
        }
        Ok(())
    }
}

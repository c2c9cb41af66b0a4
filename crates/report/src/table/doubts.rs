//! Doubts of stages about the runs of a table.

use std::collections::{BTreeMap, BTreeSet};

use posecut_graph::StageDoubt;
use posecut_stage::counted;

use super::Table;
use crate::results::RunResult;

/// The mark after a value with doubts.
pub(crate) const MARK: &str = " †";

/// The number of runs with each doubt, by stage and doubt.
pub(crate) type Doubts = BTreeMap<StageDoubt, usize>;

/// The doubts of some runs. A doubt that a run has twice counts once.
pub(crate) fn doubts<'a>(runs: impl IntoIterator<Item = &'a RunResult>) -> Doubts {
    let mut found = Doubts::new();
    for run in runs {
        for doubt in run.doubts.iter().collect::<BTreeSet<_>>() {
            *found.entry(doubt.clone()).or_default() += 1;
        }
    }
    found
}

/// The doubts for the note below a table: `pcm: nothing-kept (3 runs), …`; `None` without doubts.
pub(crate) fn listed(table: &Table) -> Option<String> {
    let mut all = Doubts::new();
    for (doubt, runs) in
        table.methods.iter().flat_map(|row| &row.cells).flatten().flat_map(|cell| &cell.doubts)
    {
        *all.entry(doubt.clone()).or_default() += runs;
    }
    let each = |(found, runs): (&StageDoubt, &usize)| {
        format!("{}: {} ({})", found.stage, found.doubt, counted(*runs, "run"))
    };
    (!all.is_empty()).then(|| all.iter().map(each).collect::<Vec<_>>().join(", "))
}

/// Whether some run of the table has several components without a doubt that reports it, as in results of older
/// programs.
pub(crate) fn is_silently_disconnected(table: &Table) -> bool {
    table.methods.iter().flat_map(|row| &row.cells).flatten().any(|cell| cell.silently_disconnected > 0)
}

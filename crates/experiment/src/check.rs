//! Compares results with expectations.

mod accept;
mod compare;
mod explain;
mod order;

pub use accept::accept;

use std::collections::BTreeSet;
use std::path::Path;

use compare::compare;

use crate::{Expected, Measured, Plan, measure};

/// The comparison of all rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// One row for each file, in the order of the plan, then means and orders.
    pub rows: Vec<Row>,
    /// The number of recorded rows whose files this plan does not make.
    pub not_checked: usize,
}

/// The comparison of one file, mean or order with its expectation.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The file below the folder of results, or the order in words.
    pub name: String,
    /// The step that writes it.
    pub stage: String,
    /// The expectations that do not hold, one sentence each.
    pub failures: Vec<String>,
    /// The expectations that hold, with their margins.
    pub notes: Vec<String>,
    /// The largest deviation as a share of its tolerance, and its quantity.
    pub largest: Option<(f64, String)>,
    /// The indices in the plan of the tasks that write it.
    pub tasks: Vec<usize>,
}

impl Report {
    /// Whether everything holds.
    pub fn holds(&self) -> bool {
        self.rows.iter().all(|row| row.failures.is_empty())
    }
}

/// Compares the outputs of a plan with the expectations. Reads every covered file.
pub fn check(expected: &Expected, plan: &Plan, results: &Path) -> Report {
    let measured = measure(plan, &expected.cover, results);
    let mut rows: Vec<Row> = measured.iter().map(|row| compare(expected, row)).collect();
    rows.extend(expected.order.iter().filter_map(|order| order::judge(order, plan, results)));
    let made: BTreeSet<&str> = measured.iter().map(|row: &Measured| row.file.as_str()).collect();
    let recorded: BTreeSet<&str> = expected
        .exact
        .iter()
        .map(|row| row.file.as_str())
        .chain(expected.close.iter().map(|row| row.file.as_str()))
        .collect();
    Report { rows, not_checked: recorded.difference(&made).count() }
}

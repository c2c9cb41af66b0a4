//! Memory in which fronts are eliminated whose factor is stored in fewer digits.

use std::sync::{Mutex, PoisonError};

use super::stored::Stored;
use crate::symbolic::{Stretch, Symbolic};

/// Workspaces that stretches of fronts use one after the other; there are at most as many as threads. One for each stretch would cost
/// time, since the system hands out memory page by page, on first use.
pub(super) struct Workspaces {
    size: usize,
    free: Mutex<Vec<Vec<f64>>>,
}

impl Workspaces {
    /// Workspaces that are large enough for all fronts of these stretches.
    pub(super) fn of<const D: usize, S: Stored>(symbolic: &Symbolic, stretches: &[Stretch]) -> Self {
        let fronts =
            stretches.iter().flat_map(|stretch| &stretch.fronts).map(|&front| &symbolic.fronts[front]);
        let size =
            fronts.map(|front| S::workspace(front.height() * front.columns * D * D)).max().unwrap_or(0);
        Self { size, free: Mutex::default() }
    }

    /// A workspace that no stretch uses at present. Old values may remain.
    pub(super) fn take(&self) -> Vec<f64> {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner).pop();
        free.unwrap_or_else(|| vec![0.0; self.size])
    }

    /// Makes a workspace free again.
    pub(super) fn give_back(&self, workspace: Vec<f64>) {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(workspace);
    }
}

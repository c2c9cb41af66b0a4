//! Limits on the effort of a search.

use std::time::Instant;

/// Limits of a search, checked at every node of branch and bound.
///
/// A work limit ends the search at the same node on every machine; a deadline does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Branch-and-bound nodes.
    pub work: u64,
    /// Nodes that one branch of the root may take. If it has not ended by then, its bound has stalled, and the search ends.
    pub stall: u64,
    /// The moment to stop at.
    pub deadline: Option<Instant>,
}

impl Limits {
    /// No limit.
    pub const NONE: Self = Self { work: u64::MAX, stall: u64::MAX, deadline: None };

    /// A limit of branch-and-bound nodes alone.
    pub fn work(nodes: u64) -> Self {
        Self { work: nodes, ..Self::NONE }
    }

    pub(super) fn is_over(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

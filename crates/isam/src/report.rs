//! Reports of updates.

/// What one [`update`](crate::IncrementalSolver::update) did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UpdateReport {
    /// Variables whose point of linearisation was moved.
    pub relinearised: usize,
    /// Edges linearised.
    pub linearised: usize,
    /// Variables eliminated again, new ones included.
    pub eliminated: usize,
    /// Cliques made.
    pub cliques: usize,
    /// Variables whose linear update was solved for.
    pub solved: usize,
    /// Components split off by removals since the last update.
    pub splits: Vec<Split>,
    /// Whether a step was refused because it led too far uphill, so that the batch solver started anew.
    pub restarted: bool,
    /// Poses that the option [`lag`](crate::IncrementalOptions::lag) marginalised at the end of this update.
    pub marginalised: usize,
    /// Nodes that the edges leave undetermined in some direction, ascending. They keep their value in this direction.
    pub undetermined: Vec<usize>,
}

/// A component that lost its connection to the rest when an edge was removed. Its poses stay the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// Its first node, which is held fixed from now on.
    pub gauge: usize,
    /// Number of its nodes.
    pub nodes: usize,
}

/// What [`finish`](crate::IncrementalSolver::finish) did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishReport {
    /// Full relinearisations, each followed by a solution of everything.
    pub iterations: usize,
    /// Whether the last step was below the tolerance.
    pub converged: bool,
    /// Whether the batch solver found a lower cost from a fresh start.
    pub restarted: bool,
    /// Cost before, with kernels.
    pub cost_before: f64,
    /// Cost after.
    pub cost: f64,
}

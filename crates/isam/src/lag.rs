//! Which poses the option `lag` marginalises, and when.

use crate::{IncrementalGroup, IncrementalSolver};

/// Poses are marginalised in blocks of this share of the lag: the poses around a block are eliminated again once a block, not
/// once a step, and a pose stays for at most this share longer.
pub(crate) const BLOCKS: usize = 10;

/// The poses that the lag has passed.
#[derive(Debug, Default)]
pub(crate) struct Lag {
    /// The first pose not yet considered.
    next: usize,
    /// Poses that were fixed when the lag passed them. A gauge becomes a variable when its component is joined to another.
    waiting: Vec<usize>,
}

impl<G: IncrementalGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// Marginalises the poses that the option `lag` lets go, and returns their number.
    pub(crate) fn marginalise_old(&mut self) -> usize {
        let Some(lag) = self.options.lag else { return 0 };
        let end = self.poses().saturating_sub(lag);
        if end < self.lag.next + (lag / BLOCKS).max(1) { 0 } else { self.marginalise_before(end) }
    }

    /// Marginalises the poses with numbers below `end`, as the option [`lag`](crate::IncrementalOptions::lag) does, for a lag
    /// that is not counted in poses. Fixed poses stay, and so do keyframes. Returns the number of marginalised poses.
    pub fn marginalise_before(&mut self, end: usize) -> usize {
        G::marginalise_before(self, end)
    }

    pub(crate) fn marginalise_before_here(&mut self, end: usize) -> usize {
        let end = end.min(self.poses());
        let mut passed = std::mem::take(&mut self.lag.waiting);
        passed.extend(self.lag.next..end);
        self.lag.next = self.lag.next.max(end);
        let mut old = Vec::with_capacity(passed.len());
        for pose in passed {
            if self.gauges.is_marginalised(pose) || self.is_keyframe(pose) {
                continue;
            }
            if self.gauges.fixed[pose] {
                self.lag.waiting.push(pose);
            } else {
                old.push(pose);
            }
        }
        let marginalised = self.marginalise(&old);
        debug_assert!(marginalised.is_ok(), "poses that are variables can be marginalised: {marginalised:?}");
        old.len()
    }

    /// Whether the options keep a pose beyond the lag.
    fn is_keyframe(&self, pose: usize) -> bool {
        let is_multiple = self.options.keep_every.is_some_and(|every| pose.is_multiple_of(every));
        is_multiple || (self.options.keep_landmark_poses && self.edges.has_landmark(pose))
    }
}

//! Limits of a search.

use std::time::{Duration, Instant};

/// The remaining budget of a search: seconds, which may end it anywhere, and units of work (about one visited edge each),
/// which end it at the same point on every machine.
#[derive(Debug, Clone)]
pub(crate) struct Budget {
    deadline: Option<Instant>,
    work: Option<u64>,
    spent: u64,
    next_look: u64,
    over: bool,
}

/// Units of work between two readings of the clock.
const LOOK: u64 = 1 << 16;

impl Budget {
    pub(crate) fn new(time: Option<Duration>, work: Option<u64>) -> Self {
        // A limit beyond the range of the clock counts as no limit.
        let deadline = time.and_then(|time| Instant::now().checked_add(time));
        Self { deadline, work, spent: 0, next_look: 0, over: false }
    }

    /// Adds work; true while the budget lasts.
    pub(crate) fn spend(&mut self, work: u64) -> bool {
        self.spent = self.spent.saturating_add(work);
        if self.work.is_some_and(|limit| self.spent > limit) {
            self.over = true;
        }
        if self.spent >= self.next_look {
            self.next_look = self.spent.saturating_add(LOOK);
            if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                self.over = true;
            }
        }
        !self.over
    }

    /// The same budget with at most this much more work.
    pub(crate) fn part(&self, work: u64) -> Self {
        let end = self.spent.saturating_add(work);
        Self { work: Some(self.work.map_or(end, |limit| limit.min(end))), ..self.clone() }
    }

    /// Adds the work of a [`part`](Self::part).
    pub(crate) fn charge(&mut self, part: &Self) {
        self.spend(part.spent - self.spent);
    }

    /// Whether an uninterruptible step of this much work would end in time. If not, the budget is over.
    pub(crate) fn affords(&mut self, work: u64) -> bool {
        let time = Duration::from_nanos(work.saturating_mul(2));
        if self.work.is_some_and(|limit| self.spent.saturating_add(work) > limit)
            || self.deadline.is_some_and(|deadline| Instant::now() + time >= deadline)
        {
            self.over = true;
        }
        !self.over
    }

    /// Whether a limit was reached.
    pub(crate) fn is_over(&self) -> bool {
        self.over
    }

    /// Work added so far.
    pub(crate) fn spent(&self) -> u64 {
        self.spent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_ends_at_its_limit_and_stays_over() {
        let mut budget = Budget::new(None, Some(10));
        assert!(budget.spend(10));
        assert!(!budget.spend(1));
        assert!(budget.is_over());
    }

    #[test]
    fn a_past_deadline_is_seen_at_once() {
        assert!(!Budget::new(Some(Duration::ZERO), None).spend(1));
        assert!(Budget::new(Some(Duration::MAX), None).spend(u64::MAX));
    }
}

//! Divides the work of a run among its groups.

use crate::clique::Limits;

/// The remaining part of a run's limit of branch-and-bound nodes. A group of `N` candidates may use the share `N^2` of what
/// the groups before it left, because the time of a node grows with `N^2`. A single group may use all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    /// The remaining share of the run's work.
    left: f64,
    /// The sum, over the remaining groups, of their squared numbers of candidates.
    squares: f64,
}

impl Budget {
    /// A full budget for groups with these numbers of candidates.
    pub(crate) fn of(candidates: impl Iterator<Item = usize>) -> Self {
        Self { left: 1.0, squares: candidates.map(square).sum() }
    }

    /// The limits of the next group, given those of a run with this group alone.
    pub(crate) fn next(&self, candidates: usize, alone: Limits) -> Limits {
        let share =
            if self.squares > 0.0 { (self.left * square(candidates) / self.squares).min(1.0) } else { 1.0 };
        let work = if share < 1.0 { (alone.work as f64 * share) as u64 } else { alone.work };
        Limits { work, ..alone }
    }

    /// Subtracts what the group has used.
    pub(crate) fn spend(&mut self, candidates: usize, alone: Limits, work: u64) {
        self.squares -= square(candidates);
        self.left = (self.left - work as f64 / alone.work.max(1) as f64).max(0.0);
    }
}

fn square(candidates: usize) -> f64 {
    (candidates as f64) * (candidates as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_group_has_all_and_several_have_no_more_together() {
        let alone = Limits::work(1000);
        let mut budget = Budget::of([5].into_iter());
        assert_eq!(budget.next(5, alone), alone);
        let groups = [30, 10, 20, 1];
        budget = Budget::of(groups.into_iter());
        let mut total = 0;
        for (turn, candidates) in groups.into_iter().enumerate() {
            let work = budget.next(candidates, alone).work;
            // The second group leaves what it had.
            let used = if turn == 1 { 0 } else { work };
            total += used;
            budget.spend(candidates, alone, used);
        }
        assert!(total > 990 && total <= 1000, "{total}");
    }
}

//! Figures of what was judged.

use std::ops::AddAssign;

use crate::clique::MaximumClique;
use crate::pairs::consistency::PairCounts;

/// Figures of a group; those of several groups add up.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figures {
    pub(crate) candidates: usize,
    pub(crate) lone_candidates: usize,
    pub(crate) groups_by_cells: usize,
    pub(crate) against_odometry: usize,
    pub(crate) counts: PairCounts,
    pub(crate) cells: usize,
    pub(crate) hypotheses: usize,
    pub(crate) hypotheses_left_out: usize,
    pub(crate) clique_size: usize,
    pub(crate) clique_upper_bound: usize,
    pub(crate) searched: Searched,
    pub(crate) grown: usize,
    pub(crate) by_chance: usize,
    pub(crate) kept: usize,
    pub(crate) work: u64,
    pub(crate) seconds_pairs: f64,
    pub(crate) seconds_clique: f64,
    pub(crate) seconds_growth: f64,
}

/// What the searches for cliques found, among candidates or hypotheses, and what their bounds leave possible.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Searched {
    pub(crate) size: usize,
    pub(crate) upper_bound: usize,
}

impl Searched {
    pub(crate) fn of(clique: &MaximumClique) -> Self {
        Self { size: clique.vertices.len(), upper_bound: clique.upper_bound }
    }
}

impl AddAssign for Searched {
    fn add_assign(&mut self, group: Self) {
        self.size += group.size;
        self.upper_bound += group.upper_bound;
    }
}

impl AddAssign for Figures {
    fn add_assign(&mut self, group: Self) {
        // All fields by name: one that is added later cannot be forgotten here.
        let Self {
            candidates,
            lone_candidates,
            groups_by_cells,
            against_odometry,
            counts,
            cells,
            hypotheses,
            hypotheses_left_out,
            clique_size,
            clique_upper_bound,
            searched,
            grown,
            by_chance,
            kept,
            work,
            seconds_pairs,
            seconds_clique,
            seconds_growth,
        } = group;
        self.candidates += candidates;
        self.lone_candidates += lone_candidates;
        self.groups_by_cells += groups_by_cells;
        self.against_odometry += against_odometry;
        self.counts += counts;
        self.cells += cells;
        self.hypotheses += hypotheses;
        self.hypotheses_left_out += hypotheses_left_out;
        self.clique_size += clique_size;
        self.clique_upper_bound += clique_upper_bound;
        self.searched += searched;
        self.grown += grown;
        self.by_chance += by_chance;
        self.kept += kept;
        self.work += work;
        self.seconds_pairs += seconds_pairs;
        self.seconds_clique += seconds_clique;
        self.seconds_growth += seconds_growth;
    }
}

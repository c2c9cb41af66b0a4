//! Figures about the judgement of groups.

use std::ops::AddAssign;

use crate::clique::MaximumClique;
use crate::pairs::consistency::PairCounts;

/// Figures of a group; those of several groups add up.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// Landmark edges tested.
    pub candidates: usize,
    /// Groups of one candidate, which has no other edge to disagree with.
    pub lone_candidates: usize,
    /// Groups solved by cells.
    pub groups_by_cells: usize,
    /// Candidates of one chain that disagree with its odometry alone.
    pub against_odometry: usize,
    /// The numbers of pairs by result.
    pub counts: PairCounts,
    /// Cells with candidates.
    pub cells: usize,
    /// Hypotheses in the clique problem.
    pub hypotheses: usize,
    /// Hypotheses of least support that the clique problem left out.
    pub hypotheses_left_out: usize,
    /// Candidates in cliques.
    pub clique_size: usize,
    /// No choice of cliques has more candidates than this.
    pub clique_upper_bound: usize,
    /// The result of the searches.
    pub searched: Searched,
    /// Candidates that growth added.
    pub grown: usize,
    /// Candidates that agree no better than chance.
    pub by_chance: usize,
    /// Candidates that are kept.
    pub kept: usize,
    /// Branch-and-bound nodes.
    pub work: u64,
    /// Seconds of testing pairs.
    pub seconds_pairs: f64,
    /// Seconds of searching for cliques.
    pub seconds_clique: f64,
    /// Seconds of growth, and of the test for agreement by chance.
    pub seconds_growth: f64,
}

/// The cliques that the searches found, among candidates or hypotheses, and their upper bounds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Searched {
    /// Candidates or hypotheses in the cliques.
    pub size: usize,
    /// No cliques have more members than this.
    pub upper_bound: usize,
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
        // All fields by name, so that a new one cannot be forgotten here.
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

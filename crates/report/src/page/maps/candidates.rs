//! Candidates of a log, and what became of them.

use posecut_graph::{EdgeKind, PoseGraph};
use posecut_view::{Kind, encode, kind};
use serde::Serialize;

/// The landmark edges of a log, one entry each in all lists.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Candidates {
    /// Ids.
    id: Vec<u64>,
    /// Indices of the first nodes, as differences.
    from: String,
    /// Indices of the second nodes, as differences.
    to: String,
    /// `a` accepted, `r` rejected, `u` undecided.
    verdict: String,
    /// `t` correct, `f` incorrect, `?` unknown.
    truth: String,
    /// Indices into `reasons`.
    reason: String,
    /// What decided: the stage, and its reason if it gives one.
    reasons: Vec<String>,
    /// How many of each kind.
    pub counts: Counts,
}

/// Numbers of candidates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// All.
    pub candidates: usize,
    /// In use.
    pub accepted: usize,
    /// Rejected by a stage.
    pub rejected: usize,
    /// Neither supported nor contradicted.
    pub undecided: usize,
    /// Accepted ones that are incorrect by their labels; `None` if no label is known.
    pub accepted_incorrect: Option<usize>,
}

impl Candidates {
    /// The candidates of a judged graph. O(edges).
    pub fn of(graph: &PoseGraph) -> Self {
        let mut found = Self::default();
        let (mut ends, mut reasons) = ([Vec::new(), Vec::new()], Vec::new());
        for edge in graph.edges_of(EdgeKind::Landmark) {
            let Some((from, to)) = graph.ends(edge) else { continue };
            found.id.push(edge.id);
            ends[0].push(from as i64);
            ends[1].push(to as i64);
            let counts = &mut found.counts;
            counts.candidates += 1;
            let (letter, count) = match kind(edge) {
                Kind::Kept | Kind::Absent => ('a', &mut counts.accepted),
                Kind::Undecided => ('u', &mut counts.undecided),
                Kind::Rejected => ('r', &mut counts.rejected),
            };
            *count += 1;
            found.verdict.push(letter);
            let truth = edge.truth_correct();
            if truth.is_some() {
                let incorrect = letter == 'a' && truth == Some(false);
                *counts.accepted_incorrect.get_or_insert(0) += usize::from(incorrect);
            }
            found.truth.push(truth.map_or('?', |correct| if correct { 't' } else { 'f' }));
            let said = edge.extra.get("verify_reason").and_then(|reason| reason.as_str());
            reasons.push(said.or(edge.rejected_by.as_deref()).unwrap_or_default());
        }
        let mut names = reasons.clone();
        names.sort_unstable();
        names.dedup();
        let index = reasons.iter().map(|reason| names.binary_search(reason).map_or(0, |found| found as i64));
        found.reason = encode::differences(index);
        found.reasons = names.into_iter().map(str::to_owned).collect();
        let [from, to] = ends.map(encode::differences);
        Self { from, to, ..found }
    }
}

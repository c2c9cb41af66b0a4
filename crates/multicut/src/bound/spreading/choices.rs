//! The tight conflicts of a solution, by the edges that it pays for.

use std::ops::Range;

use crate::bound::conflict::{Conflict, Parts};
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// Most conflicts, and most edges that they use.
const MOST: (usize, usize) = (1_000_000, 8_000_000);

/// Fewest choices of a group of several edges.
const CHOICES: usize = 4;

/// Largest share of a repulsive edge that groups may take by having both of its ends as members. Those shares cannot be moved.
const INNER: f64 = 0.8;

/// Paid edges that share conflicts.
pub(super) enum Payers {
    /// An uncut repulsive edge, by its ends.
    Repulsive(u32, u32),
    /// Cut attractive edges from a node to these others.
    Star(u32, Vec<u32>),
}

impl Payers {
    /// The conflict that a node of the cluster completes.
    pub(super) fn conflict(&self, kept: u32) -> Conflict {
        match self {
            // The repulsive edge joins the last node to the first.
            Self::Repulsive(tail, head) => Conflict::Cycle(vec![*tail, kept, *head]),
            Self::Star(centre, group) => {
                if let [single] = group[..] {
                    return Conflict::Cycle(vec![kept, *centre, single]);
                }
                let many = group.iter().copied().chain([kept]).collect();
                Conflict::Parts(Parts { few: vec![*centre], many })
            }
        }
    }
}

/// A demand for conflicts, and the choices for it.
pub(super) struct Item {
    pub(super) payers: Payers,
    pub(super) demand: f64,
    pub(super) choices: Range<usize>,
}

/// All items with their choices.
pub(super) struct Choices<'a> {
    pub(super) kernel: &'a Kernel,
    pub(super) items: Vec<Item>,
    /// For each choice, the node that completes the conflict, and where the edges that are not paid are.
    pub(super) kept: Vec<(u32, Range<usize>)>,
    pub(super) edges: Vec<u32>,
    /// What groups take of each edge between two of their members.
    inner: Vec<f64>,
}

/// A group of cut edges at one node: other ends with demands, and the nodes that complete a conflict.
struct Group {
    members: Vec<(u32, f64)>,
    kept: Vec<u32>,
}

impl<'a> Choices<'a> {
    /// Conflicts that pay for up to `size` edges. An edge's demand is divided between its ends in the ratio of `strengths`.
    pub(super) fn new(
        kernel: &'a Kernel,
        labels: &[u32],
        size: usize,
        strengths: &[f64],
        budget: &mut Budget,
    ) -> Option<Self> {
        let inner = vec![0.0; kernel.edge_count()];
        let mut all = Self { kernel, items: Vec::new(), kept: Vec::new(), edges: Vec::new(), inner };
        for node in 0..kernel.node_count() as u32 {
            for &(other, edge) in kernel.arcs(node) {
                let cost = kernel.costs[edge as usize];
                if other > node && cost < 0.0 && labels[node as usize] == labels[other as usize] {
                    let inside = all.inside(labels, node);
                    let kept: Vec<u32> = inside.filter(|&kept| all.sign(kept, other) > 0).collect();
                    all.push(Payers::Repulsive(node, other), -cost, &kept);
                }
            }
            for group in all.groups(labels, node, size, strengths) {
                let mut before = 0.0;
                // Demands differ: the whole group up to the least demand, the others up to the next, and so on.
                for (place, &(_, demand)) in group.members.iter().enumerate() {
                    let members = group.members[place..].iter().map(|member| member.0).collect();
                    if demand > before {
                        all.push(Payers::Star(node, members), demand - before, &group.kept);
                    }
                    before = demand;
                }
            }
            if !budget.spend(kernel.arcs(node).len() as u64 * 8)
                || all.kept.len() > MOST.0
                || all.edges.len() > MOST.1
            {
                return None;
            }
        }
        budget.spend(all.edges.len() as u64);
        (!all.items.is_empty()).then_some(all)
    }

    /// 1 if an edge attracts, -1 if it repels, 0 if there is none.
    fn sign(&self, tail: u32, head: u32) -> i8 {
        self.kernel
            .edge(tail, head)
            .map_or(0, |edge| if self.kernel.costs[edge as usize] > 0.0 { 1 } else { -1 })
    }

    /// Neighbours that a node attracts in its cluster.
    fn inside(&self, labels: &[u32], node: u32) -> impl Iterator<Item = u32> {
        let arcs = self.kernel.arcs(node).iter();
        let joined = arcs.filter(move |arc| labels[arc.0 as usize] == labels[node as usize]);
        joined.filter(|arc| self.kernel.costs[arc.1 as usize] > 0.0).map(|arc| arc.0)
    }

    /// The other ends of the cut attractive edges at a node, with the demands that conflicts around the node have to meet, largest
    /// first: all of an edge's capacity where the other end has no choice.
    fn demands(&self, labels: &[u32], node: u32, strengths: &[f64]) -> Vec<(u32, f64)> {
        let has_choice =
            |end: u32, other: u32| self.inside(labels, end).any(|kept| self.sign(kept, other) < 0);
        let strength = |end: u32| strengths[end as usize];
        let arcs = self.kernel.arcs(node).iter();
        let cut = arcs.filter(|arc| labels[arc.0 as usize] != labels[node as usize]);
        let attractive = cut.filter(|arc| self.kernel.costs[arc.1 as usize] > 0.0);
        let mut demands: Vec<(u32, f64)> = attractive
            .filter(|arc| has_choice(node, arc.0))
            .map(|&(other, edge)| {
                let both = has_choice(other, node);
                let share = if both { strength(node) / (strength(node) + strength(other)) } else { 1.0 };
                (other, share * self.kernel.costs[edge as usize])
            })
            .collect();
        // Edges with similar demands then meet in one group.
        demands.sort_by(|a, b| b.1.total_cmp(&a.1));
        demands
    }

    /// Groups of the cut attractive edges at a node, members by increasing demand.
    fn groups(&mut self, labels: &[u32], node: u32, size: usize, strengths: &[f64]) -> Vec<Group> {
        let inside: Vec<u32> = self.inside(labels, node).collect();
        let mut groups: Vec<Group> = Vec::new();
        for member in self.demands(labels, node, strengths) {
            let other = member.0;
            let repels = |kept: &u32| self.sign(*kept, other) < 0;
            let place = groups.iter().position(|group| {
                group.members.len() < size
                    && group.members.iter().all(|&known| self.agree(labels, known, member))
                    && group.kept.iter().filter(|kept| repels(kept)).count() >= CHOICES
            });
            if let Some(group) = place.map(|place| &mut groups[place]) {
                group.kept.retain(repels);
                for &(known, demand) in &group.members {
                    let edge = self.kernel.edge(known, other).map_or(0, |edge| edge as usize);
                    self.inner[edge] += demand.min(member.1);
                }
                group.members.push(member);
            } else {
                let kept = inside.iter().copied().filter(repels).collect();
                groups.push(Group { members: vec![member], kept });
            }
        }
        for group in &mut groups {
            group.members.sort_by(|a, b| a.1.total_cmp(&b.1));
        }
        groups
    }

    /// Whether two members may be in one group: in different clusters, with a repulsive edge that has room.
    fn agree(&self, labels: &[u32], one: (u32, f64), two: (u32, f64)) -> bool {
        labels[one.0 as usize] != labels[two.0 as usize]
            && self.kernel.edge(one.0, two.0).is_some_and(|edge| {
                let taken = self.inner[edge as usize] + one.1.min(two.1);
                taken <= -INNER * self.kernel.costs[edge as usize]
            })
    }

    fn push(&mut self, payers: Payers, demand: f64, kept: &[u32]) {
        if kept.is_empty() {
            return;
        }
        let first = self.kept.len();
        let group: &[u32] = match &payers {
            Payers::Repulsive(tail, head) => &[*tail, *head],
            Payers::Star(_, group) => group,
        };
        let repulsive = matches!(payers, Payers::Repulsive(..));
        for &node in kept {
            let start = self.edges.len();
            self.edges.extend(group.iter().filter_map(|&member| self.kernel.edge(node, member)));
            if let Payers::Star(centre, _) = payers {
                self.edges.extend(self.kernel.edge(node, centre));
            }
            for (place, &member) in group.iter().enumerate().filter(|_| !repulsive) {
                self.edges.extend(group[..place].iter().filter_map(|&other| self.kernel.edge(member, other)));
            }
            self.kept.push((node, start..self.edges.len()));
        }
        self.items.push(Item { payers, demand, choices: first..self.kept.len() });
    }
}

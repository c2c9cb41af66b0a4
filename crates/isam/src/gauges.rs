//! Which poses are constants: those that are held, and the gauge of every connected part.

use std::collections::BTreeSet;

use crate::Split;
use crate::parts::Parts;

/// Connected parts, and the poses in them that are no variables.
#[derive(Debug, Default)]
pub(crate) struct Gauges {
    parts: Parts,
    /// Poses that stay where they are, and are no variables: the gauges, and what is held.
    pub(crate) fixed: Vec<bool>,
    /// Held for good. The gauge of a part with such a pose is one.
    held: Vec<bool>,
    /// Parts split off since the last report.
    splits: Vec<Split>,
}

impl Gauges {
    /// A pose without edges: a part of its own, and its gauge.
    pub(crate) fn add_node(&mut self, held: bool) {
        self.parts.add_node();
        self.fixed.push(true);
        self.held.push(held);
    }

    /// Whether two nodes are in one part.
    pub(crate) fn are_one(&self, first: usize, second: usize) -> bool {
        self.parts.are_one(first, second)
    }

    /// The gauge of a node's part.
    pub(crate) fn of(&self, node: usize) -> usize {
        self.parts.of(node).gauge
    }

    /// The nodes of a node's part.
    pub(crate) fn part(&self, node: usize) -> &[usize] {
        &self.parts.of(node).nodes
    }

    /// Whether a pose is held for good.
    pub(crate) fn is_held(&self, node: usize) -> bool {
        self.held[node]
    }

    /// What decides which of two parts stays: the lesser one.
    pub(crate) fn rank(&self, node: usize) -> (bool, usize) {
        let gauge = self.of(node);
        (!self.held[gauge], gauge)
    }

    /// Joins the part of `gone` to that of `kept`.
    pub(crate) fn join(&mut self, kept: usize, gone: usize) {
        self.parts.join(kept, gone);
    }

    /// Looks whether two nodes are still connected. If not, a new part begins, and this is its gauge.
    pub(crate) fn split<'a, I: Iterator<Item = usize> + 'a>(
        &mut self,
        first: usize,
        second: usize,
        neighbours: impl Fn(usize) -> I,
    ) -> Option<usize> {
        let (gauge, nodes) = self.parts.split(first, second, &self.held, neighbours)?;
        self.splits.push(Split { gauge, nodes });
        Some(gauge)
    }

    /// The parts split off since the last call.
    pub(crate) fn take_splits(&mut self) -> Vec<Split> {
        std::mem::take(&mut self.splits)
    }

    /// Number of parts.
    pub(crate) fn parts(&self) -> usize {
        self.parts.count()
    }

    /// Number of parts that hold no pose but their first. O(nodes log nodes).
    pub(crate) fn floating(&self) -> usize {
        let gauges: BTreeSet<usize> = (0..self.held.len()).map(|node| self.of(node)).collect();
        gauges.into_iter().filter(|&gauge| !self.held[gauge]).count()
    }
}

//! Which poses are constants: the held ones, and the gauge of every connected component.

use std::collections::BTreeSet;

use crate::Split;
use crate::parts::Parts;

/// The connected components, and their poses that are not variables.
#[derive(Debug, Default)]
pub(crate) struct Gauges {
    parts: Parts,
    /// The poses that are not variables: gauges and held poses.
    pub(crate) fixed: Vec<bool>,
    /// The poses held for good. The gauge of a component with held poses is one of them.
    held: Vec<bool>,
    marginalised: Vec<bool>,
    /// The poses that were not marginalised, ascending.
    live: Vec<usize>,
    /// Components split off since the last report.
    splits: Vec<Split>,
}

impl Gauges {
    /// Adds a pose without edges: a component of its own, and its gauge.
    pub(crate) fn add_node(&mut self, held: bool) {
        self.parts.add_node();
        self.live.push(self.held.len());
        self.marginalised.push(false);
        self.fixed.push(true);
        self.held.push(held);
    }

    /// Whether two nodes are in one component.
    pub(crate) fn are_one(&self, first: usize, second: usize) -> bool {
        self.parts.are_one(first, second)
    }

    /// The gauge of a node's component.
    pub(crate) fn of(&self, node: usize) -> usize {
        self.parts.of(node).gauge
    }

    /// The nodes of a node's component.
    pub(crate) fn part(&self, node: usize) -> &[usize] {
        &self.parts.of(node).nodes
    }

    /// Whether a pose is held for good.
    pub(crate) fn is_held(&self, node: usize) -> bool {
        self.held[node]
    }

    /// Notes that poses were marginalised: constants that belong to their component, but have no edges.
    pub(crate) fn marginalise(&mut self, nodes: &BTreeSet<usize>) {
        for &node in nodes {
            self.marginalised[node] = true;
            self.fixed[node] = true;
        }
        self.live.retain(|node| !nodes.contains(node));
    }

    /// Whether a pose was marginalised.
    pub(crate) fn is_marginalised(&self, node: usize) -> bool {
        self.marginalised[node]
    }

    /// The poses that were not marginalised, ascending.
    pub(crate) fn live(&self) -> &[usize] {
        &self.live
    }

    /// Decides which of two components stays when they are joined: the one of lower rank.
    pub(crate) fn rank(&self, node: usize) -> (bool, usize) {
        let gauge = self.of(node);
        (!self.held[gauge], gauge)
    }

    /// Joins the component of `gone` to that of `kept`.
    pub(crate) fn join(&mut self, kept: usize, gone: usize) {
        self.parts.join(kept, gone);
    }

    /// Checks whether two nodes are still connected. If not, splits their component and returns the gauge of the new one.
    pub(crate) fn split<'a, I: Iterator<Item = usize> + 'a>(
        &mut self,
        first: usize,
        second: usize,
        neighbours: impl Fn(usize) -> I,
    ) -> Option<usize> {
        let (gauge, nodes) = self.parts.split([first, second], &self.held, &self.marginalised, neighbours)?;
        self.splits.push(Split { gauge, nodes });
        Some(gauge)
    }

    /// Takes the components split off since the last call.
    pub(crate) fn take_splits(&mut self) -> Vec<Split> {
        std::mem::take(&mut self.splits)
    }

    /// Number of components.
    pub(crate) fn parts(&self) -> usize {
        self.parts.count()
    }

    /// Number of components without held poses. O(nodes log nodes).
    pub(crate) fn floating(&self) -> usize {
        let gauges: BTreeSet<usize> = (0..self.held.len()).map(|node| self.of(node)).collect();
        gauges.into_iter().filter(|&gauge| !self.held[gauge]).count()
    }
}

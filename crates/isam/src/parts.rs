//! Connected components of a graph that changes.

use std::collections::VecDeque;

/// A connected component.
#[derive(Debug, Default)]
pub(crate) struct Part {
    /// Its fixed node: the lowest one at the time the component was made, or the lowest held one.
    pub(crate) gauge: usize,
    /// Its nodes.
    pub(crate) nodes: Vec<usize>,
}

/// Components by number. Numbers are reused.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    all: Vec<Part>,
    free: Vec<usize>,
    /// Component of each node.
    of: Vec<usize>,
    /// Marks of the search for a connection: twice the stamp, plus the side.
    mark: Vec<usize>,
    stamp: usize,
}

impl Parts {
    /// Adds a node without edges, a component of its own.
    pub(crate) fn add_node(&mut self) {
        let node = self.of.len();
        let part = self.new_part(Part { gauge: node, nodes: vec![node] });
        self.of.push(part);
        self.mark.push(0);
    }

    pub(crate) fn of(&self, node: usize) -> &Part {
        &self.all[self.of[node]]
    }

    pub(crate) fn are_one(&self, first: usize, second: usize) -> bool {
        self.of[first] == self.of[second]
    }

    /// Number of components.
    pub(crate) fn count(&self) -> usize {
        self.all.len() - self.free.len()
    }

    fn new_part(&mut self, part: Part) -> usize {
        if let Some(index) = self.free.pop() {
            self.all[index] = part;
            index
        } else {
            self.all.push(part);
            self.all.len() - 1
        }
    }

    /// Joins the component of `second` to that of `first`. O(nodes that change their component).
    pub(crate) fn join(&mut self, first: usize, second: usize) {
        let (kept, gone) = (self.of[first], self.of[second]);
        let Part { nodes, .. } = std::mem::take(&mut self.all[gone]);
        for &node in &nodes {
            self.of[node] = kept;
        }
        self.all[kept].nodes.extend(nodes);
        self.free.push(gone);
    }

    /// Checks whether two nodes of a component are still connected. If not, makes the side without the gauge a component of
    /// its own, and returns its new gauge and its number of nodes. The gauge is the lowest held node or, if none is held, the
    /// lowest node. The search alternates between both sides, so that the smaller one bounds the work. Nodes that were
    /// marginalised have no edges; they stay on the side of the gauge.
    pub(crate) fn split<'a, I: Iterator<Item = usize> + 'a>(
        &mut self,
        [first, second]: [usize; 2],
        held: &[bool],
        marginalised: &[bool],
        neighbours: impl Fn(usize) -> I,
    ) -> Option<(usize, usize)> {
        self.stamp += 1;
        let mut queues = [VecDeque::from([first]), VecDeque::from([second])];
        let mark_of = |stamp: usize, side: usize| 2 * stamp + side;
        self.mark[first] = mark_of(self.stamp, 0);
        self.mark[second] = mark_of(self.stamp, 1);
        let exhausted = 'search: loop {
            for (side, queue) in queues.iter_mut().enumerate() {
                let Some(node) = queue.pop_front() else { break 'search side };
                for neighbour in neighbours(node) {
                    if self.mark[neighbour] == mark_of(self.stamp, 1 - side) {
                        return None;
                    }
                    if self.mark[neighbour] != mark_of(self.stamp, side) {
                        self.mark[neighbour] = mark_of(self.stamp, side);
                        queue.push_back(neighbour);
                    }
                }
            }
        };
        let old = self.of[first];
        let inside = mark_of(self.stamp, exhausted);
        let gauge_inside = self.mark[self.all[old].gauge] == inside;
        let Part { gauge, nodes } = std::mem::take(&mut self.all[old]);
        let (kept, gone): (Vec<usize>, Vec<usize>) = nodes
            .into_iter()
            .partition(|&node| marginalised[node] || (self.mark[node] == inside) == gauge_inside);
        self.all[old] = Part { gauge, nodes: kept };
        let new_gauge = gone.iter().copied().min_by_key(|&node| (!held[node], node)).unwrap_or(second);
        let count = gone.len();
        let new = self.new_part(Part { gauge: new_gauge, nodes: Vec::new() });
        for &node in &gone {
            self.of[node] = new;
        }
        self.all[new].nodes = gone;
        Some((new_gauge, count))
    }
}

//! Disjoint sets of nodes.

/// Union-find with path halving (Tarjan, van Leeuwen 1984). The smaller root remains, so that results depend only on the unions.
#[derive(Debug, Clone)]
pub(crate) struct UnionFind {
    parent: Vec<u32>,
}

impl UnionFind {
    pub(crate) fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.parent.len()
    }

    pub(crate) fn find(&mut self, node: u32) -> u32 {
        let mut node = node;
        loop {
            let parent = self.parent[node as usize];
            if parent == node {
                return node;
            }
            let grandparent = self.parent[parent as usize];
            self.parent[node as usize] = grandparent;
            node = grandparent;
        }
    }

    /// Joins two sets; false if they already were one set.
    pub(crate) fn union(&mut self, first: u32, second: u32) -> bool {
        let (first, second) = (self.find(first), self.find(second));
        if first < second {
            self.parent[second as usize] = first;
        } else {
            self.parent[first as usize] = second;
        }
        first != second
    }

    /// Labels of the sets, numbered by first appearance.
    pub(crate) fn labels(&mut self) -> Vec<u32> {
        let mut labels = vec![u32::MAX; self.parent.len()];
        let mut next = 0;
        for node in 0..self.parent.len() {
            let root = self.find(node as u32) as usize;
            // The smaller root remains, so a root comes before its members.
            if root == node {
                labels[node] = next;
                next += 1;
            } else {
                labels[node] = labels[root];
            }
        }
        labels
    }
}

impl UnionFind {
    /// Splits a set into single nodes; `set` must have all its members.
    pub(crate) fn dissolve(&mut self, set: &[u32]) {
        for &node in set {
            self.parent[node as usize] = node;
        }
    }
}

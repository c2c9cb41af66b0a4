//! The top of the tree, which an update makes anew.

use posecut_geometry::LieGroup;

use crate::UpdateReport;
use crate::cliques::plan;
use crate::edges::Edges;
use crate::order::QuotientGraph;
use crate::tree::{NONE, Tree};

/// Minimum number of nodes around the newest edges that are eliminated last. In larger tops it is half of the nodes:
/// variables that come last are cheap to change, but cost fill.
const LEAST_SURROUNDINGS: usize = 8;

/// The nodes that the next rebuilding of the top affects, and the memory to order them.
#[derive(Debug, Default)]
pub(crate) struct Top {
    /// Nodes whose cliques have to be made again.
    touched: Vec<usize>,
    /// Ends of the edges added since the last update.
    new_ends: Vec<usize>,
    /// For the search around `new_ends`: the last rebuilding that reached each node.
    near: Vec<usize>,
    rebuildings: usize,
    /// Index of each node among those that are eliminated again, [`NONE`] outside of an update.
    local: Vec<usize>,
    graph: QuotientGraph,
}

impl Top {
    pub(crate) fn add_node(&mut self) {
        self.near.push(0);
        self.local.push(NONE);
    }

    /// Marks the cliques of these nodes to be made again.
    pub(crate) fn touch(&mut self, nodes: impl IntoIterator<Item = usize>) {
        self.touched.extend(nodes);
    }

    /// Notes the ends of a new edge.
    pub(crate) fn note_ends(&mut self, ends: [usize; 2]) {
        self.new_ends.extend(ends);
    }

    /// Forgets which edges are new.
    pub(crate) fn end_update(&mut self) {
        self.new_ends.clear();
    }

    /// Memory used, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.touched.capacity() * size_of::<usize>()
    }

    /// Removes the cliques of the touched nodes and their ancestors, and plans new ones. Returns the plans, children before
    /// parents, and the roots of the subtrees that stay. `loose` are cliques that hang on no other one yet.
    pub(crate) fn rebuild<G: LieGroup<DOF>, const DOF: usize>(
        &mut self,
        tree: &mut Tree,
        edges: &Edges<G, DOF>,
        loose: Vec<usize>,
        fixed: &[bool],
        report: &mut UpdateReport,
    ) -> (Vec<usize>, Vec<usize>) {
        let mut touched = std::mem::take(&mut self.touched);
        let mut marked = Vec::new();
        let mut nodes = Vec::new();
        for &node in &touched {
            if tree.of[node] != NONE {
                tree.mark_to_root(tree.of[node], &mut marked);
            } else if !fixed[node] && self.local[node] == NONE {
                // A new node: any index marks it as listed.
                self.local[node] = 0;
                nodes.push(node);
            }
        }
        let mut orphans = loose;
        tree.remove(&marked, &mut nodes, &mut orphans);
        nodes.retain(|&node| {
            tree.of[node] = NONE;
            !fixed[node]
        });
        // Old to new, so that the order does not depend on how the tree was walked.
        nodes.sort_unstable();
        for (place, &node) in nodes.iter().enumerate() {
            self.local[node] = place;
        }
        self.fill_graph(tree, edges, &nodes, &orphans);
        let plans = plan(self.graph.eliminate(), orphans.len(), nodes.len(), DOF);
        report.eliminated += nodes.len();
        report.cliques += plans.len();
        let made: Vec<usize> = plans.iter().map(|_| tree.add()).collect();
        for (plan, &index) in plans.iter().zip(&made) {
            let parent = plan.parent.map_or(NONE, |parent| made[parent]);
            for &given in &plan.given {
                tree.clique_mut(orphans[given]).parent = index;
            }
            let clique = tree.clique_mut(index);
            clique.variables.extend(plan.variables.iter().map(|&variable| nodes[variable]));
            clique.frontals = plan.frontals;
            clique.parent = parent;
            clique.children.extend(plan.given.iter().map(|&given| orphans[given]));
            for &variable in &plan.variables[..plan.frontals] {
                tree.of[nodes[variable]] = index;
            }
            if parent != NONE {
                tree.clique_mut(parent).children.push(index);
            }
        }
        for &node in &nodes {
            self.local[node] = NONE;
        }
        touched.clear();
        self.touched = touched;
        (made, orphans)
    }

    /// Makes the quotient graph of the nodes to be eliminated: their edges to each other, and the separators of the subtrees
    /// that stay. The nodes that the next updates will probably touch come last, near the root.
    fn fill_graph<G: LieGroup<DOF>, const DOF: usize>(
        &mut self,
        tree: &Tree,
        edges: &Edges<G, DOF>,
        nodes: &[usize],
        orphans: &[usize],
    ) {
        self.graph.clear(nodes.len(), orphans.len());
        for (place, &node) in nodes.iter().enumerate() {
            for other in edges.neighbours(node) {
                if self.local[other] != NONE {
                    self.graph.connect(place, self.local[other]);
                }
            }
        }
        for (element, &orphan) in orphans.iter().enumerate() {
            let clique = tree.clique(orphan);
            for &node in &clique.variables[clique.frontals..] {
                self.graph.include(element, self.local[node]);
            }
        }
        for node in self.surroundings(edges, (nodes.len() / 2).max(LEAST_SURROUNDINGS)) {
            if self.local[node] != NONE {
                self.graph.put_last(self.local[node]);
            }
        }
    }

    /// Nodes around the ends of the edges added since the last update, breadth first: the next edges will probably end there.
    fn surroundings<G: LieGroup<DOF>, const DOF: usize>(
        &mut self,
        edges: &Edges<G, DOF>,
        most: usize,
    ) -> Vec<usize> {
        let mut found: Vec<usize> = Vec::new();
        let Self { near, rebuildings, new_ends, .. } = self;
        *rebuildings += 1;
        let stamp = *rebuildings;
        let mut reach = |found: &mut Vec<usize>, node: usize| {
            if std::mem::replace(&mut near[node], stamp) != stamp {
                found.push(node);
            }
        };
        new_ends.sort_unstable_by(|a, b| b.cmp(a));
        for &node in new_ends.iter() {
            reach(&mut found, node);
        }
        let mut next = 0;
        while next < found.len() && found.len() < most {
            for other in edges.neighbours(found[next]) {
                reach(&mut found, other);
            }
            next += 1;
        }
        found
    }
}

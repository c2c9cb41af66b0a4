//! The part of the tree that an update makes anew.

use posecut_optimize::PoseGroup;

use crate::cliques::plan;
use crate::tree::NONE;
use crate::{IncrementalSolver, UpdateReport};

/// Least number of nodes around the newest edges that are eliminated last. Where more is eliminated again it is half of
/// that: what comes last is cheap to change and costs fill.
const LEAST_SURROUNDINGS: usize = 8;

impl<G: PoseGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// Takes away the cliques above what was touched and plans new ones in their place. Children come before parents.
    pub(crate) fn rebuild_top(&mut self, report: &mut UpdateReport) -> (Vec<usize>, Vec<usize>) {
        let mut touched = std::mem::take(&mut self.touched);
        let mut marked = Vec::new();
        let mut nodes = Vec::new();
        for &node in &touched {
            if self.cliques[node] != NONE {
                self.tree.mark_to_root(self.cliques[node], &mut marked);
            } else if !self.fixed[node] && self.local[node] == NONE {
                // New: any place marks it as listed.
                self.local[node] = 0;
                nodes.push(node);
            }
        }
        let mut orphans = Vec::new();
        self.tree.remove(&marked, &mut nodes, &mut orphans);
        nodes.retain(|&node| {
            self.cliques[node] = NONE;
            !self.fixed[node]
        });
        // Old to new, so that the order does not depend on how the tree was walked.
        nodes.sort_unstable();
        for (place, &node) in nodes.iter().enumerate() {
            self.local[node] = place;
        }
        self.fill_graph(&nodes, &orphans);
        let plans = plan(self.graph.eliminate(), orphans.len(), nodes.len(), DOF);
        report.eliminated += nodes.len();
        report.cliques += plans.len();
        let made: Vec<usize> = plans.iter().map(|_| self.tree.add()).collect();
        for (plan, &index) in plans.iter().zip(&made) {
            let parent = plan.parent.map_or(NONE, |parent| made[parent]);
            for &given in &plan.given {
                self.tree.clique_mut(orphans[given]).parent = index;
            }
            let clique = self.tree.clique_mut(index);
            clique.variables.extend(plan.variables.iter().map(|&variable| nodes[variable]));
            clique.frontals = plan.frontals;
            clique.parent = parent;
            clique.children.extend(plan.given.iter().map(|&given| orphans[given]));
            for &variable in &plan.variables[..plan.frontals] {
                self.cliques[nodes[variable]] = index;
            }
            if parent != NONE {
                self.tree.clique_mut(parent).children.push(index);
            }
        }
        for &node in &nodes {
            self.local[node] = NONE;
        }
        touched.clear();
        self.touched = touched;
        (made, orphans)
    }

    /// The quotient graph of nodes to be eliminated: edges among them, and the separators of subtrees that stay. What the next
    /// updates will touch comes last, near the root.
    fn fill_graph(&mut self, nodes: &[usize], orphans: &[usize]) {
        self.graph.clear(nodes.len(), orphans.len());
        for (place, &node) in nodes.iter().enumerate() {
            for other in self.edges.neighbours(node) {
                if self.local[other] != NONE {
                    self.graph.connect(place, self.local[other]);
                }
            }
        }
        for (element, &orphan) in orphans.iter().enumerate() {
            let clique = self.tree.clique(orphan);
            for &node in &clique.variables[clique.frontals..] {
                self.graph.include(element, self.local[node]);
            }
        }
        for node in self.surroundings((nodes.len() / 2).max(LEAST_SURROUNDINGS)) {
            if self.local[node] != NONE {
                self.graph.put_last(self.local[node]);
            }
        }
    }

    /// Nodes around the ends of the edges that have come since the last update, breadth first: what the next edges will
    /// probably join.
    fn surroundings(&mut self, most: usize) -> Vec<usize> {
        let mut found: Vec<usize> = Vec::new();
        let Self { near, edges, solutions, new_ends, .. } = self;
        // Solutions are counted after this: the number is not yet a mark.
        let stamp = *solutions + 1;
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

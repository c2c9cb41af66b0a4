//! Marginalisation: old poses leave the solver, and what their edges say about the others stays.

use std::collections::{BTreeMap, BTreeSet};

use crate::elimination::Restricted;
use crate::prior::Prior;
use crate::tree::Clique;
use crate::{IncrementalError, IncrementalGroup, IncrementalSolver};

impl<G: IncrementalGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// Marginalises poses: they keep their estimates from now on, and their edges turn into a prior on the poses around them.
    ///
    /// The prior is the marginal of the quadratic model at the current points of linearisation: the update matrix that
    /// remains of a front in which the marginalised poses are eliminated first. It is stored as relative poses with one
    /// information matrix, so that it stays exact when all of its poses move together. Only the bending of its relative poses
    /// after this call is a linear approximation. The cost at the current estimate does not change.
    ///
    /// Call [`update`](Self::update) before, so that edges added since then are linearised at good estimates; the next update
    /// takes the poses out of the tree. From now on an edge to such a pose, and the removal of an edge that was at one, are
    /// errors. Naming a pose twice in one call counts once. Memory: a prior over `k` poses takes `(k DOF)^2` numbers, and a
    /// marginalised pose a constant amount.
    ///
    /// # Errors
    /// If a pose does not exist, was marginalised before, or is fixed: a held pose, or the gauge of its component. A fixed
    /// pose is a constant and costs nothing; without it the component would lose its position. Nothing changes then.
    pub fn marginalise(&mut self, poses: &[usize]) -> Result<(), IncrementalError> {
        G::marginalise(self, poses)
    }

    pub(crate) fn marginalise_here(&mut self, poses: &[usize]) -> Result<(), IncrementalError> {
        let nodes: BTreeSet<usize> = poses.iter().copied().collect();
        for &pose in &nodes {
            if pose >= self.poses() {
                return Err(IncrementalError::UnknownPose { pose, poses: self.poses() });
            }
            if self.gauges.is_marginalised(pose) {
                return Err(IncrementalError::MarginalisedTwice { pose });
            }
            if self.gauges.fixed[pose] {
                return Err(IncrementalError::FixedPose { pose, held: self.gauges.is_held(pose) });
            }
        }
        if nodes.is_empty() {
            return Ok(());
        }
        self.edges.linearise(&self.estimate.points);
        for group in self.groups(&nodes) {
            self.absorb(&group);
        }
        let gauges = &mut self.gauges;
        gauges.marginalise(&nodes);
        Ok(())
    }

    /// Whether a pose was marginalised.
    pub fn is_marginalised(&self, pose: usize) -> bool {
        pose < self.poses() && self.gauges.is_marginalised(pose)
    }

    /// The poses that were not marginalised, ascending.
    pub fn live_poses(&self) -> &[usize] {
        self.gauges.live()
    }

    /// Number of poses of every prior that marginalised poses have left.
    pub fn prior_sizes(&self) -> Vec<usize> {
        self.priors.list().map(|prior| prior.nodes.len()).collect()
    }

    /// Splits poses into groups that edges or priors connect, each ascending.
    fn groups(&self, nodes: &BTreeSet<usize>) -> Vec<Vec<usize>> {
        let mut pending = nodes.clone();
        let mut groups = Vec::new();
        while let Some(first) = pending.pop_first() {
            let mut group = vec![first];
            let mut next = 0;
            while next < group.len() {
                let node = group[next];
                next += 1;
                for other in self.edges.neighbours(node).chain(self.priors.neighbours(node)) {
                    if pending.remove(&other) {
                        group.push(other);
                    }
                }
            }
            group.sort_unstable();
            groups.push(group);
        }
        groups
    }

    /// Turns the edges and priors at a connected group of variables into one prior on the poses around it.
    fn absorb(&mut self, group: &[usize]) {
        let mut around: BTreeSet<usize> = group
            .iter()
            .flat_map(|&node| self.edges.neighbours(node).chain(self.priors.neighbours(node)))
            .collect();
        let inside: BTreeSet<usize> = group.iter().copied().collect();
        around.retain(|node| !inside.contains(node));
        self.top.touch(group.iter().chain(&around).copied());

        // Held poses never move: the first one is the anchor, and the model is conditional on the others.
        let first_held = around.iter().copied().find(|&node| self.gauges.is_held(node));
        around.retain(|&node| !self.gauges.is_held(node) || Some(node) == first_held);
        let anchor = first_held.or_else(|| around.iter().copied().find(|&node| !self.gauges.fixed[node]));

        let old = self.priors.take(group, &mut self.tree);
        let edges = self.edges.absorb(group);
        let pose = |node| self.estimate.pose(node);
        let mut cost = edges.iter().map(|(edge, _)| self.cost_of(edge)).fold(0.0, |sum, cost| sum + cost);
        cost += old.iter().map(|prior| prior.cost(pose)).fold(0.0, |sum, cost| sum + cost);
        match anchor {
            Some(anchor) if around.len() > 1 => {
                let model = self.eliminate_group(group, &around, &old, &edges);
                let mut prior = Prior::freeze(&model, anchor, &self.estimate.points);
                prior.set_cost(cost, &self.estimate);
                self.priors.add(prior, &mut self.tree);
            }
            // A single pose around the group stays undetermined by it.
            _ => self.priors.constant += cost,
        }
        for &node in group {
            self.estimate.reset(node, self.estimate.pose(node));
            self.movement.reset(node);
            self.substitution.reset(node);
            self.gauges.fixed[node] = true;
        }
    }

    /// Eliminates a group with the kernel of the tree's cliques, and returns the model that this leaves on the poses around.
    fn eliminate_group(
        &mut self,
        group: &[usize],
        around: &BTreeSet<usize>,
        old: &[Prior<G, DOF>],
        edges: &[AbsorbedEdge<G, DOF>],
    ) -> Clique {
        let index = self.tree.add();
        let members: BTreeSet<usize> = group.iter().chain(around).copied().collect();
        for prior in old {
            let child = self.tree.add();
            prior.expand(&self.estimate.points, |node| members.contains(&node), self.tree.clique_mut(child));
            self.tree.clique_mut(index).children.push(child);
        }
        let clique = self.tree.clique_mut(index);
        clique.frontals = group.len();
        clique.variables.extend(group.iter().chain(around));
        let incidence = Restricted::new(edges.iter().map(|(edge, model)| (edge.from, edge.to, model)));
        self.elimination.eliminate(&mut self.tree, &[index], &incidence, &self.estimate.deltas);
        let mut model = self.tree.extract(index);
        for child in std::mem::take(&mut model.children) {
            self.tree.discard(child);
        }

        // A front holds the diagonal blocks of its frontal variables only: add those of the poses around.
        let places: BTreeMap<usize, usize> =
            around.iter().enumerate().map(|(place, &node)| (node, place)).collect();
        let order = around.len() * DOF + 1;
        for (edge, blocks) in edges {
            for (node, block, gradient) in [
                (edge.from, &blocks.from_from, &blocks.from_gradient),
                (edge.to, &blocks.to_to, &blocks.to_gradient),
            ] {
                let Some(&place) = places.get(&node) else { continue };
                for column in 0..DOF {
                    let start = (place * DOF + column) * order;
                    for row in column..DOF {
                        model.update[start + place * DOF + row] += block[(row, column)];
                    }
                    model.update[start + order - 1] -= gradient[column];
                }
            }
        }
        model.variables.drain(..group.len());
        model
    }
}

/// An edge that a prior absorbs, and its quadratic model.
pub(crate) type AbsorbedEdge<G, const DOF: usize> =
    (posecut_optimize::Edge<G, DOF>, posecut_optimize::model::Linearised<DOF>);

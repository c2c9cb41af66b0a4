//! Moving poses along the stiffest edges.
//!
//! A step `d` moves every pose by its own twist, `X_i Exp(d_i)`. Where a large motion meets a small bend, the relative pose of two
//! neighbours then errs by the commutator of both, `[Ad(X_ij^-1) d_i, w] / 2` for a change `w` of the relative pose. On a long drive
//! this costs millimetre edges metres, and only tiny steps lower the cost. This retraction composes the poses along a
//! spanning tree instead: every edge of the tree changes by exactly `w_ij = d_j - Ad(X_ij^-1) d_i`, what the linear model says. The tree
//! has the stiffest edges, so what remains of the error lies on the weakest edge of every cycle. Relative coordinates
//! go back to E. Olson, J. Leonard, S. Teller, "Fast iterative alignment of pose graphs with poor initial estimates", ICRA 2006.

use std::collections::VecDeque;

use nalgebra::SVector;
use posecut_cholesky::Adjacency;
use posecut_geometry::LieGroup;
use posecut_graph::connectivity::Forest;

use crate::model::term::Term;

/// Edges of a minimum spanning tree by variance, parents before children. Held nodes are the roots.
pub(super) struct StiffTree {
    edges: Vec<(usize, usize)>,
}

impl StiffTree {
    /// The tree of a graph with `nodes` nodes, of which the first `held` are roots; empty if the terms do not span the
    /// graph. O(terms log terms).
    pub(super) fn new<G, T: Term<G, DOF>, const DOF: usize>(
        terms: &[T],
        nodes: usize,
        held: usize,
        length: f64,
    ) -> Self {
        let mut links: Vec<_> = terms.iter().filter_map(|term| term.link(length)).collect();
        links.sort_by(|a, b| a.variance.total_cmp(&b.variance).then((a.from, a.to).cmp(&(b.from, b.to))));
        let mut forest = Forest::new(nodes);
        for root in 1..held {
            forest.join(0, root);
        }
        links.retain(|link| forest.join(link.from, link.to));
        let arcs = links.iter().flat_map(|link| [(link.from, link.to), (link.to, link.from)]);
        let neighbours = Adjacency::new(nodes, arcs);
        let mut edges = Vec::with_capacity(nodes);
        let mut seen = vec![false; nodes];
        seen[..held].fill(true);
        let mut queue: VecDeque<usize> = (0..held).collect();
        while let Some(parent) = queue.pop_front() {
            for &child in neighbours.of(parent) {
                if !std::mem::replace(&mut seen[child], true) {
                    edges.push((parent, child));
                    queue.push_back(child);
                }
            }
        }
        if edges.len() + held != nodes {
            edges.clear();
        }
        Self { edges }
    }

    /// Whether it leads nowhere.
    pub(super) fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// Moves `poses` by the step into `moved`, edge by edge of the tree. O(nodes).
    pub(super) fn retract<G: LieGroup<DOF>, const DOF: usize>(
        &self,
        poses: &[G],
        held: usize,
        step: &[SVector<f64, DOF>],
        moved: &mut Vec<G>,
    ) {
        moved.clear();
        moved.extend_from_slice(poses);
        for &(parent, child) in &self.edges {
            let relative = poses[parent].between(&poses[child]);
            let mut change = step[child - held];
            if let Some(variable) = parent.checked_sub(held) {
                change -= relative.inverse().adjoint() * step[variable];
            }
            moved[child] = moved[parent].compose(&relative).compose(&G::exp(&change));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::problem::{Edge, EdgeKind};
    use nalgebra::SMatrix;
    use posecut_geometry::SE3;

    /// On a ring, all edges but the weakest change by what the linear model says, however long the step.
    #[test]
    fn edges_of_the_tree_change_as_the_linear_model_says() {
        let nodes = 12;
        let tangent = |seed: usize, size: f64| {
            SVector::<f64, 6>::from_fn(|axis, _| size * ((seed * 7 + axis * 3) as f64 * 1.3).sin())
        };
        let mut poses = vec![SE3::identity()];
        for node in 1..nodes {
            poses.push(poses[node - 1].compose(&SE3::exp(&tangent(node, 1.0))));
        }
        let edges: Vec<_> = (0..nodes)
            .map(|from| {
                let weight = if from == 4 { 0.1 } else { 1.0 };
                let to = (from + 1) % nodes;
                let between = poses[from].between(&poses[to]);
                Edge::new(from, to, between, SMatrix::identity() * weight, EdgeKind::Odometry)
            })
            .collect();
        let step: Vec<_> = (1..nodes).map(|node| tangent(node + 50, 0.8)).collect();
        let tree = StiffTree::new::<SE3, _, 6>(&edges, nodes, 1, 1.0);
        let mut moved = Vec::new();
        tree.retract(&poses, 1, &step, &mut moved);
        for (index, edge) in edges.iter().enumerate() {
            let relative = poses[edge.from].between(&poses[edge.to]);
            let of = |node: usize| if node == 0 { SVector::zeros() } else { step[node - 1] };
            let change = of(edge.to) - relative.inverse().adjoint() * of(edge.from);
            let found = relative.between(&moved[edge.from].between(&moved[edge.to])).log();
            let error = (found - change).amax();
            assert_eq!(error < 1e-12, index != 4, "{index} {error}");
        }
    }
}

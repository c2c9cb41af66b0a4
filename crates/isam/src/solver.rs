//! The incremental solver.

use posecut_optimize::model::{charge, check_edge, distance, is_finite};
use posecut_optimize::{Edge, ProblemError, residual};

use crate::edges::Edges;
use crate::elimination::Elimination;
use crate::estimate::Estimate;
use crate::gauges::Gauges;
use crate::lag::Lag;
use crate::movement::Movement;
use crate::priors::Priors;
use crate::restarts::Restarts;
use crate::substitution::Substitution;
use crate::top::Top;
use crate::tree::Tree;
use crate::{IncrementalError, IncrementalGroup, IncrementalOptions};

/// The number of an edge. Numbers are never reused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeId(pub u64);

/// Poses and edges that are added and removed, and the estimate of the poses.
///
/// [`add_pose`](Self::add_pose), [`add_edge`](Self::add_edge) and [`remove_edge`](Self::remove_edge) record changes; the next
/// [`update`](Self::update) applies them to the estimate. The result depends only on the sequence of calls.
#[derive(Debug)]
pub struct IncrementalSolver<G, const DOF: usize> {
    pub(crate) options: IncrementalOptions,
    pub(crate) estimate: Estimate<G, DOF>,
    pub(crate) edges: Edges<G, DOF>,
    pub(crate) priors: Priors<G, DOF>,
    pub(crate) gauges: Gauges,
    pub(crate) tree: Tree,
    pub(crate) top: Top,
    pub(crate) elimination: Elimination<DOF>,
    pub(crate) substitution: Substitution<DOF>,
    pub(crate) movement: Movement<DOF>,
    pub(crate) restarts: Restarts,
    pub(crate) lag: Lag,
    pub(crate) updates: usize,
}

impl<G: IncrementalGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// A solver without poses.
    pub fn new(options: IncrementalOptions) -> Result<Self, IncrementalError> {
        options.check()?;
        Ok(Self {
            options,
            estimate: Estimate::default(),
            edges: Edges::new(),
            priors: Priors::new(),
            gauges: Gauges::default(),
            tree: Tree::default(),
            top: Top::default(),
            elimination: Elimination::new(),
            substitution: Substitution::default(),
            movement: Movement::new(&options),
            restarts: Restarts::default(),
            lag: Lag::default(),
            updates: 0,
        })
    }

    /// Adds a pose and returns its number, counted from 0. The pose is a component of its own, fixed at `pose`, until an edge
    /// joins it to another component. If it is the later of the two, it then moves to where the edge puts it.
    pub fn add_pose(&mut self, pose: G) -> Result<usize, IncrementalError> {
        self.add(pose, false)
    }

    /// Adds a pose that is a constant for good: g2o's `FIX`. A component with such a pose does not move when an edge joins it
    /// to another; an edge between two such components constrains both.
    pub fn add_held_pose(&mut self, pose: G) -> Result<usize, IncrementalError> {
        self.add(pose, true)
    }

    fn add(&mut self, pose: G, held: bool) -> Result<usize, IncrementalError> {
        let node = self.poses();
        if !is_finite(&pose) {
            return Err(ProblemError::PoseNotFinite { node }.into());
        }
        self.estimate.add(pose);
        self.edges.add_node();
        self.gauges.add_node(held);
        self.tree.add_node();
        self.top.add_node();
        self.elimination.add_node();
        self.substitution.add_node();
        self.movement.add_node();
        Ok(node)
    }

    /// Adds an edge. The errors are those of [`Problem::new`](posecut_optimize::Problem::new); they name the edge by the
    /// number that it would get. An edge to a marginalised pose is an error, too.
    ///
    /// If the edge joins two components, the one with the later gauge moves rigidly so that the edge's residual is zero. This
    /// takes time proportional to its nodes. Components with held poses do not move.
    pub fn add_edge(&mut self, edge: Edge<G, DOF>) -> Result<EdgeId, IncrementalError> {
        G::add_edge(self, edge)
    }

    pub(crate) fn add_edge_here(&mut self, edge: Edge<G, DOF>) -> Result<EdgeId, IncrementalError> {
        check_edge(self.edges.next_id() as usize, &edge, self.poses())?;
        let Edge { from, to, .. } = edge;
        if let Some(pose) = [from, to].into_iter().find(|&node| self.gauges.is_marginalised(node)) {
            return Err(IncrementalError::MarginalisedPose { edge: self.edges.next_id(), from, to, pose });
        }
        if !self.gauges.are_one(edge.from, edge.to) {
            self.join(&edge);
        }
        self.top.touch([edge.from, edge.to]);
        self.top.note_ends([edge.from, edge.to]);
        self.movement.reach += distance(&edge.measurement);
        Ok(EdgeId(self.edges.add(edge)))
    }

    /// Removes an edge and returns it, so that it can be added again. An edge that was at a marginalised pose cannot be removed.
    ///
    /// If this splits a component, the side without a gauge keeps its poses. Its first node is fixed from now on, unless
    /// other nodes of it are held, and the next [`UpdateReport`](crate::UpdateReport) names it. The search for another
    /// connection takes time proportional to the smaller side.
    pub fn remove_edge(&mut self, id: EdgeId) -> Result<Edge<G, DOF>, IncrementalError> {
        G::remove_edge(self, id)
    }

    pub(crate) fn remove_edge_here(&mut self, id: EdgeId) -> Result<Edge<G, DOF>, IncrementalError> {
        let edge = self.edges.remove(id.0)?;
        self.top.touch([edge.from, edge.to]);
        self.restarts.strained = true;
        let (edges, priors) = (&self.edges, &self.priors);
        let neighbours = |node| edges.neighbours(node).chain(priors.neighbours(node));
        if let Some(gauge) = self.gauges.split(edge.from, edge.to, neighbours) {
            self.fix(gauge, true);
        }
        Ok(edge)
    }

    /// Moves the component of one end so that the edge fits, and releases its gauge. The component with held poses stays, and
    /// the other one moves; if both have held poses, neither moves.
    fn join(&mut self, edge: &Edge<G, DOF>) {
        let (from, to) = (self.estimate(edge.from), self.estimate(edge.to));
        let (kept, gone, motion) = if self.gauges.rank(edge.from) < self.gauges.rank(edge.to) {
            (edge.from, edge.to, from.compose(&edge.measurement).compose(&to.inverse()))
        } else {
            (edge.to, edge.from, to.compose(&from.compose(&edge.measurement).inverse()))
        };
        let gauge = self.gauges.of(gone);
        let is_held = self.gauges.is_held(gauge);
        if !is_held {
            for &node in self.gauges.part(gone) {
                let pose = &mut self.estimate.points[node];
                *pose = motion.compose(pose);
            }
        }
        self.gauges.join(kept, gone);
        if !is_held {
            self.fix(gauge, false);
        }
    }

    /// Turns a variable into a gauge or a gauge into a variable, at its current pose.
    fn fix(&mut self, node: usize, fixed: bool) {
        self.gauges.fixed[node] = fixed;
        self.relinearise(node);
    }

    /// Makes the estimate the point of linearisation.
    pub(crate) fn relinearise(&mut self, node: usize) {
        self.estimate.reset(node, self.estimate.pose(node));
        self.movement.reset(node);
        self.substitution.reset(node);
        self.touch(node);
    }

    /// Marks everything that depends on the point of linearisation of a node.
    fn touch(&mut self, node: usize) {
        self.top.touch([node]);
        self.top.touch(self.edges.neighbours(node));
        self.top.touch(self.priors.neighbours(node));
        self.edges.outdate(node);
        self.priors.outdate(node);
    }

    /// The current estimate of a pose.
    pub fn estimate(&self, node: usize) -> G {
        self.estimate.pose(node)
    }

    /// The current estimates of all poses.
    pub fn estimates(&self) -> Vec<G> {
        self.estimate.poses()
    }

    /// Number of poses.
    pub fn poses(&self) -> usize {
        self.estimate.points.len()
    }

    /// The current edges, by number.
    pub fn edges(&self) -> Vec<(EdgeId, Edge<G, DOF>)> {
        self.edges.list().map(|(id, edge)| (EdgeId(id), *edge)).collect()
    }

    /// Number of connected components.
    pub fn parts(&self) -> usize {
        self.gauges.parts()
    }

    /// Number of connected components without held poses: only their gauge fixes their position. O(nodes log nodes).
    pub fn floating_parts(&self) -> usize {
        self.gauges.floating()
    }

    /// Sum of `rho(e^T Omega e)` over the edges at the estimate, and the cost of the priors that marginalised edges have left.
    pub fn cost(&self) -> f64 {
        G::cost(self)
    }

    /// The cost of an edge at the estimate.
    pub(crate) fn cost_of(&self, edge: &Edge<G, DOF>) -> f64 {
        cost_between(edge, &self.estimate(edge.from), &self.estimate(edge.to))
    }

    pub(crate) fn cost_at(&self, pose: impl Fn(usize) -> G) -> f64 {
        let costs = self.edges.list().map(|(_, edge)| cost_between(edge, &pose(edge.from), &pose(edge.to)));
        let edges = costs.fold(0.0, |sum, cost| sum + cost);
        edges + self.priors.cost(pose)
    }

    /// Memory used for cliques and edges, bytes. It depends on the graph and on its largest size so far, not on how often
    /// edges were added and removed.
    pub fn bytes(&self) -> usize {
        let cliques = self.tree.scalars() * size_of::<f64>() + self.priors.bytes();
        cliques + self.edges.bytes() + self.movement.bytes() + self.top.bytes()
    }

    /// Number of edges that marginalisation has turned into priors.
    pub fn absorbed_edges(&self) -> usize {
        self.edges.absorbed()
    }

    /// Number of scalar blocks, pose by pose, that the cliques of the tree hold.
    pub fn tree_blocks(&self) -> usize {
        self.tree.blocks()
    }

    /// Number of current edges. O(1).
    pub fn edge_count(&self) -> usize {
        self.edges.count()
    }
}

fn cost_between<G: IncrementalGroup<DOF>, const DOF: usize>(edge: &Edge<G, DOF>, from: &G, to: &G) -> f64 {
    let error = residual(&edge.measurement, from, to);
    charge(edge.kernel, error.dot(&(edge.information * error))).0
}

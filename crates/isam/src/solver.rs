//! The incremental solver.

use posecut_optimize::model::{Term as _, check_edge, distance, is_finite};
use posecut_optimize::{Edge, PoseGroup, ProblemError};

use crate::edges::Edges;
use crate::elimination::Elimination;
use crate::estimate::Estimate;
use crate::gauges::Gauges;
use crate::movement::Movement;
use crate::restarts::Restarts;
use crate::substitution::Substitution;
use crate::top::Top;
use crate::tree::Tree;
use crate::{IncrementalError, IncrementalOptions};

/// The number of an edge, given when it is added and never again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeId(pub u64);

/// Poses and edges that come and go, and the estimate of the poses.
///
/// Changes are taken by [`add_pose`](Self::add_pose), [`add_edge`](Self::add_edge) and
/// [`remove_edge`](Self::remove_edge), and enter the estimate at the next [`update`](Self::update). The result depends on
/// the sequence of calls alone.
#[derive(Debug)]
pub struct IncrementalSolver<G, const DOF: usize> {
    pub(crate) options: IncrementalOptions,
    pub(crate) estimate: Estimate<G, DOF>,
    pub(crate) edges: Edges<G, DOF>,
    pub(crate) gauges: Gauges,
    pub(crate) tree: Tree,
    pub(crate) top: Top,
    pub(crate) elimination: Elimination<DOF>,
    pub(crate) substitution: Substitution<DOF>,
    pub(crate) movement: Movement<DOF>,
    pub(crate) restarts: Restarts,
    pub(crate) updates: usize,
}

impl<G: PoseGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// A solver without poses.
    pub fn new(options: IncrementalOptions) -> Result<Self, IncrementalError> {
        options.check()?;
        Ok(Self {
            options,
            estimate: Estimate::default(),
            edges: Edges::new(),
            gauges: Gauges::default(),
            tree: Tree::default(),
            top: Top::default(),
            elimination: Elimination::new(),
            substitution: Substitution::default(),
            movement: Movement::new(&options),
            restarts: Restarts::default(),
            updates: 0,
        })
    }

    /// Adds a pose and returns its number: poses are counted from 0. It is a part of its own, held at `pose`, until an
    /// edge joins it to another: that edge, not `pose`, places it then, if it is the later of the two.
    pub fn add_pose(&mut self, pose: G) -> Result<usize, IncrementalError> {
        self.add(pose, false)
    }

    /// Adds a pose that stays where it is for good, as a constant: g2o's `FIX`. A part with such a pose is moved by no edge that
    /// joins it to another; an edge between two of them pulls at both.
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

    /// Adds an edge. The errors are those of [`Problem::new`](posecut_optimize::Problem::new); they name the edge by the number it
    /// would have had.
    ///
    /// If it joins two parts, the one with the later gauge moves rigidly so that the edge's residual is zero, which takes
    /// time proportional to its nodes. Parts with poses that are held do not move.
    pub fn add_edge(&mut self, edge: Edge<G, DOF>) -> Result<EdgeId, IncrementalError> {
        check_edge(self.edges.next_id() as usize, &edge, self.poses())?;
        if !self.gauges.are_one(edge.from, edge.to) {
            self.join(&edge);
        }
        self.top.touch([edge.from, edge.to]);
        self.top.note_ends([edge.from, edge.to]);
        self.movement.reach += distance(&edge.measurement);
        Ok(EdgeId(self.edges.add(edge)))
    }

    /// Takes an edge back and returns it, so that it can be added again.
    ///
    /// If that disconnects a part of the graph, the part stays where it is, its first node is fixed from now on unless others are
    /// held, and
    /// the next [`UpdateReport`](crate::UpdateReport) says so. Looking for another connection takes time proportional to the smaller side.
    pub fn remove_edge(&mut self, id: EdgeId) -> Result<Edge<G, DOF>, IncrementalError> {
        let edge = self.edges.remove(id.0)?;
        self.top.touch([edge.from, edge.to]);
        self.restarts.strained = true;
        let edges = &self.edges;
        if let Some(gauge) = self.gauges.split(edge.from, edge.to, |node| edges.neighbours(node)) {
            self.fix(gauge, true);
        }
        Ok(edge)
    }

    /// Moves the part of one end so that the edge fits, and releases its gauge, unless poses of it are held: then, if those of the
    /// other end are not, that one moves.
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

    /// Makes a variable of a gauge, or a gauge of a variable, where it is.
    fn fix(&mut self, node: usize, fixed: bool) {
        self.gauges.fixed[node] = fixed;
        self.relinearise(node);
    }

    /// Moves the point of linearisation to the estimate.
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
        self.edges.outdate(node);
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

    /// The edges that are there, by number.
    pub fn edges(&self) -> Vec<(EdgeId, Edge<G, DOF>)> {
        self.edges.list().map(|(id, edge)| (EdgeId(id), *edge)).collect()
    }

    /// Number of connected parts.
    pub fn parts(&self) -> usize {
        self.gauges.parts()
    }

    /// Number of connected parts that hold no pose but their first, which nothing else places. O(nodes log nodes).
    pub fn floating_parts(&self) -> usize {
        self.gauges.floating()
    }

    /// Sum of `rho(e^T Omega e)` over the edges at the estimate.
    pub fn cost(&self) -> f64 {
        self.cost_at(&self.estimates())
    }

    pub(crate) fn cost_at(&self, poses: &[G]) -> f64 {
        self.edges.list().map(|(_, edge)| edge.cost(poses)).fold(0.0, |sum, cost| sum + cost)
    }

    /// Memory held for cliques and edges, bytes. It depends on the graph and on how large it has been, not on how often
    /// edges came and went.
    pub fn bytes(&self) -> usize {
        self.tree.scalars() * size_of::<f64>() + self.edges.bytes() + self.movement.bytes() + self.top.bytes()
    }
}

//! The incremental solver.

use std::collections::BTreeSet;

use nalgebra::SVector;
use posecut_optimize::model::{Term as _, check_edge, distance, is_finite};
use posecut_optimize::{Edge, PoseGroup, ProblemError};

use crate::edges::Edges;
use crate::elimination::Elimination;
use crate::estimate::Estimate;
use crate::order::QuotientGraph;
use crate::parts::Parts;
use crate::tree::{NONE, Tree};
use crate::update::Restarts;
use crate::{IncrementalError, IncrementalOptions, Split};

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
    /// Linear updates that subtrees below were last solved with.
    pub(crate) propagated: Vec<SVector<f64, DOF>>,
    /// Linear updates for which edges have been looked at.
    pub(crate) checked: Vec<SVector<f64, DOF>>,
    /// The clique in which a variable is frontal.
    pub(crate) cliques: Vec<usize>,
    /// Where they are, and no variables: the gauges, and what is held.
    pub(crate) fixed: Vec<bool>,
    /// Held for good. The gauge of a part with such a pose is one.
    held: Vec<bool>,
    pub(crate) edges: Edges<G, DOF>,
    parts: Parts,
    pub(crate) tree: Tree,
    /// Nodes whose cliques have to be made again.
    pub(crate) touched: Vec<usize>,
    /// Nodes whose linear update has changed by more than a threshold since edges have been looked at.
    pub(crate) moved: Vec<usize>,
    /// Nodes whose linear update may exceed a threshold.
    pub(crate) candidates: Vec<usize>,
    pub(crate) splits: Vec<Split>,
    pub(crate) updates: usize,
    pub(crate) graph: QuotientGraph,
    pub(crate) elimination: Elimination<DOF>,
    /// Place of a node in the part that is eliminated again, [`NONE`] outside of an update.
    pub(crate) local: Vec<usize>,
    /// The last solution that changed a node's linear update by more than the threshold.
    pub(crate) changed: Vec<usize>,
    pub(crate) solutions: usize,
    /// Ends of the edges that have come since the last update.
    pub(crate) new_ends: Vec<usize>,
    /// Marks of the search around them.
    pub(crate) near: Vec<usize>,
    pub(crate) known: Vec<f64>,
    /// Whether the estimate may be in a wrong basin: a step was too long to trust, or an edge was taken back.
    pub(crate) strained: bool,
    /// Whether the last solution turned a pose too far to be trusted.
    pub(crate) long_step: bool,
    pub(crate) restarts: Restarts,
    /// The sum of all measured distances, those of edges taken back included.
    pub(crate) reach: f64,
}

impl<G: PoseGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// A solver without poses.
    pub fn new(options: IncrementalOptions) -> Result<Self, IncrementalError> {
        options.check()?;
        Ok(Self {
            options,
            estimate: Estimate::default(),
            propagated: Vec::new(),
            checked: Vec::new(),
            cliques: Vec::new(),
            fixed: Vec::new(),
            held: Vec::new(),
            edges: Edges::new(),
            parts: Parts::default(),
            tree: Tree::default(),
            touched: Vec::new(),
            moved: Vec::new(),
            candidates: Vec::new(),
            splits: Vec::new(),
            updates: 0,
            graph: QuotientGraph::default(),
            elimination: Elimination::new(),
            local: Vec::new(),
            changed: Vec::new(),
            solutions: 0,
            new_ends: Vec::new(),
            near: Vec::new(),
            known: Vec::new(),
            strained: false,
            long_step: false,
            restarts: Restarts::default(),
            reach: 0.0,
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
        self.propagated.push(SVector::zeros());
        self.checked.push(SVector::zeros());
        self.cliques.push(NONE);
        self.fixed.push(true);
        self.held.push(held);
        self.local.push(NONE);
        self.changed.push(0);
        self.near.push(0);
        self.edges.add_node();
        self.parts.add_node();
        self.elimination.add_node();
        Ok(node)
    }

    /// Adds an edge. The errors are those of [`Problem::new`](crate::Problem::new); they name the edge by the number it
    /// would have had.
    ///
    /// If it joins two parts, the one with the later gauge moves rigidly so that the edge's residual is zero, which takes
    /// time proportional to its nodes. Parts with poses that are held do not move.
    pub fn add_edge(&mut self, edge: Edge<G, DOF>) -> Result<EdgeId, IncrementalError> {
        check_edge(self.edges.next_id() as usize, &edge, self.poses())?;
        if !self.parts.are_one(edge.from, edge.to) {
            self.join(&edge);
        }
        self.touched.extend([edge.from, edge.to]);
        self.new_ends.extend([edge.from, edge.to]);
        self.reach += distance(&edge.measurement);
        Ok(EdgeId(self.edges.add(edge)))
    }

    /// Takes an edge back and returns it, so that it can be added again.
    ///
    /// If that disconnects a part of the graph, the part stays where it is, its first node is fixed from now on unless others are
    /// held, and
    /// the next [`UpdateReport`](crate::UpdateReport) says so. Looking for another connection takes time proportional to the smaller side.
    pub fn remove_edge(&mut self, id: EdgeId) -> Result<Edge<G, DOF>, IncrementalError> {
        let edge = self.edges.remove(id.0)?;
        self.touched.extend([edge.from, edge.to]);
        self.strained = true;
        let edges = &self.edges;
        if let Some((gauge, nodes)) =
            self.parts.split(edge.from, edge.to, &self.held, |node| edges.neighbours(node))
        {
            self.splits.push(Split { gauge, nodes });
            self.fix(gauge, true);
        }
        Ok(edge)
    }

    /// Moves the part of one end so that the edge fits, and releases its gauge, unless poses of it are held: then, if those of the
    /// other end are not, that one moves.
    fn join(&mut self, edge: &Edge<G, DOF>) {
        let (from, to) = (self.estimate(edge.from), self.estimate(edge.to));
        let (kept, gone, motion) = if self.rank(edge.from) < self.rank(edge.to) {
            (edge.from, edge.to, from.compose(&edge.measurement).compose(&to.inverse()))
        } else {
            (edge.to, edge.from, to.compose(&from.compose(&edge.measurement).inverse()))
        };
        let gauge = self.parts.of(gone).gauge;
        if !self.held[gauge] {
            for &node in &self.parts.of(gone).nodes {
                let pose = &mut self.estimate.points[node];
                *pose = motion.compose(pose);
            }
        }
        self.parts.join(kept, gone);
        if !self.held[gauge] {
            self.fix(gauge, false);
        }
    }

    /// What decides which of two parts stays: the lesser one.
    fn rank(&self, node: usize) -> (bool, usize) {
        let gauge = self.parts.of(node).gauge;
        (!self.held[gauge], gauge)
    }

    /// Makes a variable of a gauge, or a gauge of a variable, where it is.
    fn fix(&mut self, node: usize, fixed: bool) {
        self.fixed[node] = fixed;
        self.relinearise(node);
    }

    /// Moves the point of linearisation to the estimate.
    pub(crate) fn relinearise(&mut self, node: usize) {
        self.estimate.reset(node, self.estimate.pose(node));
        self.checked[node] = SVector::zeros();
        self.propagated[node] = SVector::zeros();
        self.touch(node);
    }

    /// Marks everything that depends on the point of linearisation of a node.
    fn touch(&mut self, node: usize) {
        self.touched.push(node);
        self.touched.extend(self.edges.neighbours(node));
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
        self.parts.count()
    }

    /// Number of connected parts that hold no pose but their first, which nothing else places. O(nodes log nodes).
    pub fn floating_parts(&self) -> usize {
        let gauges: BTreeSet<usize> = (0..self.held.len()).map(|node| self.parts.of(node).gauge).collect();
        gauges.into_iter().filter(|&gauge| !self.held[gauge]).count()
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
        let nodes = self.moved.capacity() + self.candidates.capacity() + self.touched.capacity();
        self.tree.scalars() * size_of::<f64>() + self.edges.bytes() + nodes * size_of::<usize>()
    }
}

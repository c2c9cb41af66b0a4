//! The incremental solver.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Arch;
use nalgebra::SVector;

use super::cliques::plan;
use super::edges::Edges;
use super::elimination::Elimination;
use super::options::translations;
use super::order::QuotientGraph;
use super::parts::Parts;
use super::substitution;
use super::tree::{NONE, Tree};
use super::{IncrementalError, IncrementalOptions, Split, UpdateReport};
use crate::PoseGroup;
use crate::problem::{Edge, ProblemError, check_edge, is_finite};
use crate::residual::Term as _;

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
    options: IncrementalOptions,
    /// Points of linearisation.
    pub(super) points: Vec<G>,
    /// Linear updates: the estimate is `point * Exp(delta)`.
    pub(super) deltas: Vec<SVector<f64, DOF>>,
    /// Linear updates that subtrees below were last solved with.
    propagated: Vec<SVector<f64, DOF>>,
    /// The clique in which a variable is frontal.
    cliques: Vec<usize>,
    /// Held where they are: the gauges.
    fixed: Vec<bool>,
    pub(super) edges: Edges<G, DOF>,
    parts: Parts,
    tree: Tree,
    /// Nodes whose cliques have to be made again.
    touched: Vec<usize>,
    /// Nodes whose linear update exceeds a threshold.
    moved: Vec<usize>,
    splits: Vec<Split>,
    updates: usize,
    graph: QuotientGraph,
    elimination: Elimination<DOF>,
    /// Place of a node in the part that is eliminated again, [`NONE`] outside of an update.
    local: Vec<usize>,
    /// The last solution that changed a node's linear update by more than the threshold.
    changed: Vec<usize>,
    solutions: usize,
    known: Vec<f64>,
    /// Whether the estimate may be in a wrong basin: a step was too long to trust, or an edge was taken back.
    pub(super) strained: bool,
    /// Whether the last solution turned a pose too far to be trusted.
    long_step: bool,
    restarts: Restarts,
}

/// When to solve anew inside of an update. A restart takes as long as a batch solution, so that those that did not help
/// make the next ones rarer.
#[derive(Debug, Default)]
struct Restarts {
    not_before: usize,
    pause: usize,
}

/// A rotation beyond which a Gauss-Newton step is not trusted without a look at the cost, radians.
const LONG_ROTATION: f64 = 0.5;

impl<G: PoseGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// A solver without poses.
    pub fn new(options: IncrementalOptions) -> Result<Self, IncrementalError> {
        options.check()?;
        Ok(Self {
            options,
            points: Vec::new(),
            deltas: Vec::new(),
            propagated: Vec::new(),
            cliques: Vec::new(),
            fixed: Vec::new(),
            edges: Edges::new(),
            parts: Parts::default(),
            tree: Tree::default(),
            touched: Vec::new(),
            moved: Vec::new(),
            splits: Vec::new(),
            updates: 0,
            graph: QuotientGraph::default(),
            elimination: Elimination::new(),
            local: Vec::new(),
            changed: Vec::new(),
            solutions: 0,
            known: Vec::new(),
            strained: false,
            long_step: false,
            restarts: Restarts::default(),
        })
    }

    /// Adds a pose and returns its number: poses are counted from 0. It is a part of its own, held at `pose`, until an
    /// edge joins it to another: that edge, not `pose`, places it then, if it is the later of the two.
    pub fn add_pose(&mut self, pose: G) -> Result<usize, IncrementalError> {
        let node = self.points.len();
        if !is_finite(&pose) {
            return Err(ProblemError::PoseNotFinite { node }.into());
        }
        self.points.push(pose);
        self.deltas.push(SVector::zeros());
        self.propagated.push(SVector::zeros());
        self.cliques.push(NONE);
        self.fixed.push(true);
        self.local.push(NONE);
        self.changed.push(0);
        self.edges.add_node();
        self.parts.add_node();
        self.elimination.add_node();
        Ok(node)
    }

    /// Adds an edge. The errors are those of [`Problem::new`](crate::Problem::new); they name the edge by the number it
    /// would have had.
    ///
    /// If it joins two parts, the one with the later gauge moves rigidly so that the edge's residual is zero, which takes
    /// time proportional to its nodes.
    pub fn add_edge(&mut self, edge: Edge<G, DOF>) -> Result<EdgeId, IncrementalError> {
        check_edge(self.edges.next_id() as usize, &edge, self.points.len())?;
        if !self.parts.are_one(edge.from, edge.to) {
            self.join(&edge);
        }
        self.touched.extend([edge.from, edge.to]);
        Ok(EdgeId(self.edges.add(edge)))
    }

    /// Takes an edge back and returns it, so that it can be added again.
    ///
    /// If that disconnects a part of the graph, the part stays where it is, its first node is held fixed from now on, and
    /// the next [`UpdateReport`] says so. Looking for another connection takes time proportional to the smaller side.
    pub fn remove_edge(&mut self, id: EdgeId) -> Result<Edge<G, DOF>, IncrementalError> {
        let edge = self.edges.remove(id.0)?;
        self.touched.extend([edge.from, edge.to]);
        self.strained = true;
        let edges = &self.edges;
        if let Some((gauge, nodes)) = self.parts.split(edge.from, edge.to, |node| edges.neighbours(node)) {
            self.splits.push(Split { gauge, nodes });
            self.points[gauge] = self.estimate(gauge);
            self.fix(gauge, true);
        }
        Ok(edge)
    }

    /// Moves the part of one end so that the edge fits, and releases its gauge.
    fn join(&mut self, edge: &Edge<G, DOF>) {
        let (from, to) = (self.estimate(edge.from), self.estimate(edge.to));
        let (kept, gone, motion) = if self.parts.of(edge.from).gauge < self.parts.of(edge.to).gauge {
            (edge.from, edge.to, from.compose(&edge.measurement).compose(&to.inverse()))
        } else {
            (edge.to, edge.from, to.compose(&from.compose(&edge.measurement).inverse()))
        };
        let gauge = self.parts.of(gone).gauge;
        for &node in &self.parts.of(gone).nodes {
            self.points[node] = motion.compose(&self.points[node]);
        }
        self.parts.join(kept, gone);
        self.fix(gauge, false);
    }

    /// Makes a variable of a gauge, or a gauge of a variable, at its point of linearisation.
    fn fix(&mut self, node: usize, fixed: bool) {
        self.fixed[node] = fixed;
        self.deltas[node] = SVector::zeros();
        self.propagated[node] = SVector::zeros();
        self.touch(node);
    }

    /// Marks everything that depends on the point of linearisation of a node.
    fn touch(&mut self, node: usize) {
        self.touched.push(node);
        self.touched.extend(self.edges.neighbours(node));
        self.edges.outdate(node);
    }

    /// Brings the estimate up to date with all changes.
    ///
    /// Gauss-Newton steps that turn a pose by more than half a radian and raise the cost are not taken: the batch solver
    /// starts anew then, and the report says so.
    pub fn update(&mut self) -> UpdateReport {
        let mut report = UpdateReport { splits: std::mem::take(&mut self.splits), ..UpdateReport::default() };
        let due = self.updates.is_multiple_of(self.options.relinearise_every);
        self.updates += 1;
        if due {
            self.relinearise_moved(&mut report);
        }
        self.solve(&mut report, self.options.propagate);
        if due {
            for _ in 1..self.options.iterations {
                if !self.relinearise_moved(&mut report) {
                    break;
                }
                self.solve(&mut report, self.options.propagate);
            }
        }
        if self.long_step {
            self.guard(&mut report);
        }
        report.undetermined.sort_unstable();
        report.undetermined.dedup();
        report
    }

    /// Restarts after a step that was too long and led uphill.
    fn guard(&mut self, report: &mut UpdateReport) {
        self.strained = true;
        if self.updates < self.restarts.not_before || self.cost() <= self.cost_at(&self.points) {
            return;
        }
        report.restarted = true;
        self.restarts.pause = if self.restart() { 0 } else { (2 * self.restarts.pause).max(8) };
        self.restarts.not_before = self.updates + self.restarts.pause;
    }

    /// Moves the points of linearisation of variables beyond the thresholds to the estimate. False if there were none.
    fn relinearise_moved(&mut self, report: &mut UpdateReport) -> bool {
        let before = report.relinearised;
        for node in std::mem::take(&mut self.moved) {
            if !self.fixed[node] && self.is_moved(node) {
                self.relinearise(node);
                report.relinearised += 1;
            }
        }
        report.relinearised > before
    }

    fn is_moved(&self, node: usize) -> bool {
        let beyond =
            |(component, value): (usize, &f64)| value.abs() > self.options.relinearise(component, DOF);
        self.deltas[node].iter().enumerate().any(beyond)
    }

    fn relinearise(&mut self, node: usize) {
        self.points[node] = self.estimate(node);
        self.deltas[node] = SVector::zeros();
        self.propagated[node] = SVector::zeros();
        self.touch(node);
    }

    /// Eliminates again what was touched, and solves.
    fn solve(&mut self, report: &mut UpdateReport, threshold: f64) {
        self.long_step = false;
        report.linearised += self.edges.linearise(&self.points);
        let (made, orphans) = self.rebuild_top(report);
        let Self { tree, edges, elimination, .. } = self;
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for &clique in &made {
                    elimination.eliminate(tree, clique, edges);
                }
            },
        );
        for &clique in &made {
            report.undetermined.extend_from_slice(&self.tree.clique(clique).undetermined);
        }
        self.substitute(&made, orphans, threshold, report);
    }

    /// Takes away the cliques above what was touched and plans new ones in their place. Children come before parents.
    fn rebuild_top(&mut self, report: &mut UpdateReport) -> (Vec<usize>, Vec<usize>) {
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
        self.fill_graph(&nodes, &orphans, &touched);
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

    /// The quotient graph of nodes to be eliminated: edges among them, and the separators of subtrees that stay.
    fn fill_graph(&mut self, nodes: &[usize], orphans: &[usize], touched: &[usize]) {
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
        for &node in touched {
            if self.local[node] != NONE {
                self.graph.put_last(self.local[node]);
            }
        }
    }

    /// Solves the new cliques, and the subtrees below them as far as their separators change.
    fn substitute(&mut self, made: &[usize], orphans: Vec<usize>, threshold: f64, report: &mut UpdateReport) {
        self.solutions += 1;
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for &index in made.iter().rev() {
                    self.solve_clique(index, threshold, report);
                }
                let mut pending = orphans;
                while let Some(index) = pending.pop() {
                    let clique = self.tree.clique(index);
                    let mut separator = clique.variables[clique.frontals..].iter();
                    if separator.any(|&node| self.changed[node] == self.solutions) {
                        pending.extend_from_slice(&clique.children);
                        self.solve_clique(index, threshold, report);
                    }
                }
            },
        );
    }

    #[inline(always)]
    fn solve_clique(&mut self, index: usize, threshold: f64, report: &mut UpdateReport) {
        let clique = self.tree.clique(index);
        substitution::solve(clique, &self.deltas, &mut self.known);
        report.solved += clique.frontals;
        for (&node, values) in clique.variables[..clique.frontals].iter().zip(self.known.chunks_exact(DOF)) {
            let value = SVector::from_column_slice(values);
            self.deltas[node] = value;
            if (value - self.propagated[node]).amax() > threshold {
                self.propagated[node] = value;
                self.changed[node] = self.solutions;
            }
            let beyond =
                |(component, value): (usize, &f64)| value.abs() > self.options.relinearise(component, DOF);
            if value.iter().enumerate().any(beyond) {
                self.moved.push(node);
                self.long_step |=
                    value.iter().skip(translations(DOF)).any(|angle| !(angle.abs() <= LONG_ROTATION));
            }
        }
    }

    /// Relinearises every variable and solves for all. Returns the largest component of the linear update that is left:
    /// the length of the next Gauss-Newton step.
    pub fn relinearise_all(&mut self) -> (f64, UpdateReport) {
        let mut report = UpdateReport { splits: std::mem::take(&mut self.splits), ..UpdateReport::default() };
        for node in 0..self.points.len() {
            if !self.fixed[node] {
                self.relinearise(node);
                report.relinearised += 1;
            }
        }
        self.moved.clear();
        self.solve(&mut report, 0.0);
        let step = self.deltas.iter().map(SVector::amax).fold(0.0, f64::max);
        (step, report)
    }

    /// The current estimate of a pose.
    pub fn estimate(&self, node: usize) -> G {
        self.points[node].compose(&G::exp(&self.deltas[node]))
    }

    /// The current estimates of all poses.
    pub fn estimates(&self) -> Vec<G> {
        (0..self.points.len()).map(|node| self.estimate(node)).collect()
    }

    /// Number of poses.
    pub fn poses(&self) -> usize {
        self.points.len()
    }

    /// The edges that are there, by number.
    pub fn edges(&self) -> Vec<(EdgeId, Edge<G, DOF>)> {
        self.edges.list().map(|(id, edge)| (EdgeId(id), *edge)).collect()
    }

    /// Number of connected parts.
    pub fn parts(&self) -> usize {
        self.parts.count()
    }

    /// Sum of `rho(e^T Omega e)` over the edges at the estimate.
    pub fn cost(&self) -> f64 {
        self.cost_at(&self.estimates())
    }

    pub(super) fn cost_at(&self, poses: &[G]) -> f64 {
        self.edges.list().map(|(_, edge)| edge.cost(poses)).sum()
    }

    /// Memory held for cliques and edges, bytes. It depends on the graph and on how large it has been, not on how often
    /// edges came and went.
    pub fn bytes(&self) -> usize {
        self.tree.scalars() * size_of::<f64>() + self.edges.bytes()
    }
}

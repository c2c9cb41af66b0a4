//! Full solutions: the final one, and fresh starts.

use std::collections::BTreeMap;

use nalgebra::SVector;
use posecut_geometry::translations;
use posecut_optimize::model::{Magnitude, Term as _};
use posecut_optimize::{Edge, EdgeKind, Initialisation, Options, Problem, optimize};

use crate::prior::Prior;

use crate::{FinishReport, IncrementalGroup, IncrementalSolver};

/// Maximum number of full relinearisations in [`IncrementalSolver::finish`].
const MOST_ITERATIONS: usize = 100;
/// [`IncrementalSolver::finish`] ends when no component of a step exceeds this: shares of the median measured distance, and
/// radians.
const STEP_TOLERANCE: f64 = 1e-10;
/// Largest slope, as a cosine, that is accepted in directions that the equations leave undetermined.
const SLOPE: f64 = 1e-6;
/// Steps below this that no longer shrink are rounding errors.
const ROUNDING: f64 = 1e-7;
/// A fresh start is taken if it lowers the cost by more than this share.
const BETTER: f64 = 1e-9;

/// How a fresh solution by the batch solver went.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreshStart {
    /// Whether it cost less than the estimate, and was taken.
    pub(crate) is_better: bool,
    /// Whether the batch solver converged.
    pub(crate) converged: bool,
    /// Steps over all poses.
    pub(crate) steps: usize,
}

impl<G: IncrementalGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// Relinearises everything until no pose moves: the estimate is then that of a fresh solution of the current edges.
    ///
    /// If edges were removed since the last call, if a step was too long to be trusted, or if full steps do not converge, the
    /// batch solver starts anew (see [`restart`](Self::restart)). So a false edge leaves no trace, even if it had folded the
    /// map into another basin.
    pub fn finish(&mut self) -> FinishReport {
        G::finish(self)
    }

    pub(crate) fn finish_here(&mut self) -> FinishReport {
        let cost_before = self.cost();
        let mut report = FinishReport {
            iterations: 0,
            converged: false,
            restarted: false,
            cost_before,
            cost: cost_before,
        };
        if self.restarts.strained {
            report.restarted = self.restart();
        }
        self.iterate(&mut report);
        if !report.converged && self.restart() {
            report.restarted = true;
            self.iterate(&mut report);
        }
        self.restarts.strained = !report.converged;
        report.cost = self.cost();
        report
    }

    /// Takes Gauss-Newton steps until they converge or lead uphill.
    fn iterate(&mut self, report: &mut FinishReport) {
        let (mut cost, mut last_step) = (self.cost(), f64::INFINITY);
        let magnitude = self.magnitude();
        for _ in 0..MOST_ITERATIONS {
            report.iterations += 1;
            let (_, update) = self.relinearise_all();
            let steps = self.gauges.live().iter().map(|&node| &self.estimate.deltas[node]);
            let step =
                steps.map(|step| magnitude.largest(step.iter(), translations(DOF))).fold(0.0, f64::max);
            let next = self.cost();
            if !(next.is_finite() && next <= cost + BETTER * cost.max(magnitude.noiseless())) {
                self.go_to_points();
                return;
            }
            report.converged = step <= STEP_TOLERANCE || (step <= ROUNDING && step > 0.5 * last_step);
            // Directions that were held because they are numerically undetermined may still have a slope.
            if report.converged && !update.undetermined.is_empty() && self.cosine() > SLOPE {
                report.converged = false;
                return;
            }
            if report.converged {
                return;
            }
            (cost, last_step) = (next, step);
        }
    }

    /// Runs the batch solver from its best start, and takes the result if it costs less than the estimate. Returns whether it
    /// did. Takes as long as a batch solution.
    pub fn restart(&mut self) -> bool {
        G::restart(self)
    }

    /// Does [`restart`](Self::restart), and returns how it went.
    pub(crate) fn fresh_start(&mut self) -> FreshStart {
        let cost = self.cost();
        let nodes = self.gauges.live().to_vec();
        let problem = self.live_problem(&nodes);
        let solution =
            optimize(&problem, &Options { initialisation: Initialisation::Best, ..Options::default() });
        let gain = BETTER * cost.max(self.magnitude().noiseless());
        let mut is_better = solution.cost < cost - gain || !cost.is_finite();
        if self.priors.list().next().is_some() {
            // The batch solver has approximated the priors by edges.
            let poses: BTreeMap<usize, G> =
                nodes.iter().copied().zip(solution.poses.iter().copied()).collect();
            is_better = self.cost_at(|node| poses[&node]) < cost - gain || !cost.is_finite();
        }
        if is_better {
            for (&node, pose) in nodes.iter().zip(solution.poses) {
                self.go_to(node, pose);
            }
            let reached = self.cost();
            self.relinearise_all();
            // Where the batch solver had to damp, an undamped step from its result can lead uphill.
            if !(self.cost() <= reached + gain) {
                self.go_to_points();
            }
        }
        FreshStart { is_better, converged: solution.converged, steps: solution.iterations }
    }

    /// The live poses, the edges and, for every prior, edges from its anchor, for the batch solver.
    fn live_problem(&self, nodes: &[usize]) -> Problem<G, DOF> {
        let places: BTreeMap<usize, usize> =
            nodes.iter().enumerate().map(|(place, &node)| (node, place)).collect();
        let place = |node| places[&node];
        let edges =
            self.edges.list().map(|(_, edge)| Edge { from: place(edge.from), to: place(edge.to), ..*edge });
        let stars = self.stars();
        let stars = stars.map(|star| Edge { from: place(star.from), to: place(star.to), ..star });
        let edges = edges.chain(stars).collect();
        let estimates = nodes.iter().map(|&node| self.estimate(node)).collect();
        let fixed = nodes.iter().map(|&node| self.gauges.fixed[node]).collect();
        Problem::from_checked(estimates, edges, fixed)
    }

    /// The largest `|g_k| / sqrt(H_kk cost)` over all components of the poses that are not fixed, as in
    /// [`Options::gradient_tolerance`]. O(edges).
    fn cosine(&self) -> f64 {
        let poses = self.estimates();
        let mut equations: Vec<[SVector<f64, DOF>; 2]> = vec![[SVector::zeros(); 2]; poses.len()];
        let mut cost = self.magnitude().noiseless();
        for (_, edge) in self.edges.list() {
            let model = edge.linearise(&poses);
            cost += model.cost;
            for (node, gradient, block) in
                [(edge.from, model.from_gradient, model.from_from), (edge.to, model.to_gradient, model.to_to)]
            {
                equations[node][0] += gradient;
                equations[node][1] += block.diagonal();
            }
        }
        for prior in self.priors.list() {
            prior.add_to(&mut equations, &poses);
            cost += prior.cost(|node| poses[node]);
        }
        let free = equations.iter().zip(&self.gauges.fixed).filter(|&(_, &fixed)| !fixed);
        let squares = free.flat_map(|([gradient, diagonal], _)| {
            gradient.iter().zip(diagonal).map(|(g, h)| if *g == 0.0 { 0.0 } else { g * (g / h) })
        });
        (squares.fold(0.0, f64::max) / cost).sqrt()
    }

    /// Edges from the anchors of the priors to their other poses.
    fn stars(&self) -> impl Iterator<Item = Edge<G, DOF>> + '_ {
        let stars = self.priors.list().flat_map(Prior::star);
        stars.map(|(anchor, node, measurement, information)| {
            Edge::new(anchor, node, measurement, information, EdgeKind::Odometry)
        })
    }

    /// The magnitude that tolerances refer to. O(edges).
    fn magnitude(&self) -> Magnitude {
        let edges: Vec<_> = self.edges.list().map(|(_, edge)| *edge).chain(self.stars()).collect();
        Magnitude::of(edges.iter())
    }

    /// Sets both the estimate and the point of linearisation of a node to a pose.
    fn go_to(&mut self, node: usize, pose: G) {
        self.estimate.reset(node, pose);
        self.movement.reset(node);
    }

    /// Sets the estimates to the points of linearisation.
    pub(crate) fn go_to_points(&mut self) {
        for place in 0..self.gauges.live().len() {
            let node = self.gauges.live()[place];
            self.go_to(node, self.estimate.points[node]);
        }
    }
}

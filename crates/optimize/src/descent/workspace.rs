//! Memory of the iteration, and the operations that all step methods share: equations, steps, and trials.

use nalgebra::{SMatrix, SVector};
use posecut_cholesky::{Memory, MixedFactor};
use posecut_geometry::translations;

use super::conjugate_step::iterations;
use super::outcome::Step;
use super::phases::{Phases, timed};
use super::stiff_tree::StiffTree;
use crate::model::cost::total;
use crate::model::lanes::LaneGroup;
use crate::model::magnitude::Magnitude;
use crate::model::prior::{self, Prior};
use crate::model::retraction::{retract, retract_by_screws};
use crate::model::term::Term;
use crate::normal_equations::{NormalEquations, Pattern};

/// Damping raises every diagonal entry to at least this share of the largest one. Marquardt's scaling alone would not damp a
/// direction that hardly any edge measures, and steps in it would have no bound.
const DAMPING_FLOOR: f64 = 1e-9;

/// A direction softer than this, as a share of the diagonal, is rounding.
const SOFTEST: f64 = 1e-14;

/// Factorisations after which a descent may count as slow, if nothing is known of the graph: not before it counts as hard
/// (`batch::component`).
const PATIENCE: usize = 20;

/// Memory of the iteration, reserved once.
pub(crate) struct Workspace<'a, G, const DOF: usize> {
    pub(crate) pattern: &'a Pattern,
    /// The reference values of tolerances.
    pub(crate) magnitude: Magnitude,
    /// Measurements of single nodes, which belong to every cost that is minimised.
    pub(crate) priors: Vec<Prior<G, DOF>>,
    pub(crate) equations: NormalEquations<DOF>,
    pub(crate) factor: MixedFactor<DOF>,
    /// The damping of the matrix that was factorised last, and its floor.
    damping: (f64, [f64; DOF]),
    /// Whether the equations still have the matrix that was factorised last.
    is_factorised: bool,
    /// Whether the last step with an old factor, which is that of an undamped matrix, promised little: the poses are near the minimum.
    pub(super) is_near: bool,
    /// Iterations that a step by conjugate gradients may take.
    pub(super) conjugate_iterations: usize,
    /// Factorisations after which a descent may count as slow.
    pub(crate) patience: usize,
    pub(crate) step: Vec<SVector<f64, DOF>>,
    pub(crate) trial: Vec<G>,
    /// The tree of the stiffest edges, once it was needed; empty if they span no tree.
    pub(super) tree: Option<StiffTree>,
    /// Memory of the exact second derivative, once it was needed.
    pub(super) exact: Option<NormalEquations<DOF>>,
    /// Seconds so far, over all calls.
    pub(crate) phases: Phases,
}

impl<'a, G: LaneGroup<DOF>, const DOF: usize> Workspace<'a, G, DOF> {
    pub(crate) fn new(pattern: &'a Pattern, magnitude: Magnitude, memory: Memory) -> Self {
        Self {
            pattern,
            magnitude,
            priors: Vec::new(),
            equations: NormalEquations::new(pattern),
            factor: MixedFactor::with_memory(&pattern.symbolic, memory),
            damping: (0.0, [0.0; DOF]),
            is_factorised: false,
            is_near: false,
            patience: PATIENCE,
            conjugate_iterations: iterations::<DOF>(&pattern.symbolic),
            step: vec![SVector::zeros(); pattern.variables],
            trial: Vec::new(),
            tree: None,
            exact: None,
            phases: Phases::default(),
        }
    }

    /// Adds priors to every cost.
    pub(crate) fn with_priors(mut self, priors: &[Prior<G, DOF>]) -> Self {
        self.magnitude = self.magnitude.with_priors(priors);
        self.priors = priors.to_vec();
        self
    }

    /// The cost that tolerances refer to: at least that of a graph without noise.
    pub(crate) fn at_least(&self, cost: f64) -> f64 {
        cost.max(self.magnitude.noiseless())
    }

    /// The largest `|g_k| / sqrt(H_kk cost)`, the cosine of the angle between the whitened residuals and their derivative by
    /// a component of a pose; infinite if the cost is not finite.
    pub(crate) fn cosine(&self, cost: f64) -> f64 {
        if !cost.is_finite() {
            return f64::INFINITY;
        }
        let steepest = self.equations.steepest();
        if steepest == 0.0 { 0.0 } else { (steepest / self.at_least(cost)).sqrt() }
    }

    /// The minimum value of diagonal entries in damping, by component: a share of the largest entry, in units of the graph's
    /// length.
    fn damping_floor(&self) -> [f64; DOF] {
        let length = self.magnitude.length;
        let unit = |axis: usize| if axis < translations(DOF) { length * length } else { 1.0 };
        let largest = |block: &SMatrix<f64, DOF, DOF>| {
            (0..DOF).map(|axis| block[(axis, axis)] * unit(axis)).fold(0.0, f64::max)
        };
        let largest = self.equations.diagonal.iter().map(largest).fold(0.0, f64::max);
        std::array::from_fn(|axis| DAMPING_FLOOR * largest / unit(axis))
    }

    /// `D` of damping: the diagonal, at least the floor.
    pub(super) fn damping_scale(&self) -> Vec<SVector<f64, DOF>> {
        let floor = self.damping_floor();
        let diagonal = self.equations.diagonal.iter();
        diagonal.map(|block| SVector::from_fn(|axis, _| block[(axis, axis)].max(floor[axis]))).collect()
    }

    /// `d^T H d / d^T D d` for the step: how stiff the edges are along it, as a share of the diagonal. Damping of this size halves
    /// the step.
    pub(super) fn stiffness(&self, step: &Step, damping: f64) -> f64 {
        let scale = self.damping_scale();
        let norm: f64 =
            self.step.iter().zip(&scale).map(|(block, scale)| block.component_mul(block).dot(scale)).sum();
        ((step.promised / norm) - damping).clamp(SOFTEST, 1.0)
    }

    /// The damped step `(H + damping D) d = -g`.
    pub(crate) fn solve(&mut self, damping: f64, undetermined: &mut Option<(usize, usize)>) -> Option<Step> {
        self.damping = (damping, self.damping_floor());
        self.is_factorised = true;
        let Self { factor, equations, pattern, phases, .. } = self;
        let matrix = equations.damped(self.damping);
        if let Err(breakdown) =
            timed(&mut phases.factorisation, || factor.factorize(&pattern.symbolic, matrix))
        {
            undetermined.get_or_insert((self.pattern.held + breakdown.variable, breakdown.component));
            return None;
        }
        if let Some((variable, component)) = self.factor.undetermined() {
            undetermined.get_or_insert((self.pattern.held + variable, component));
            return None;
        }
        let mut step = self.substitute()?;
        if damping > 0.0 {
            for (block, scale) in self.step.iter().zip(&self.damping_scale()) {
                step.promised += damping * block.component_mul(block).dot(scale);
            }
        }
        Some(step)
    }

    /// The step `d = -A^-1 g` for the matrix that was factorised last; `None` if it is not finite. It is as exact as the factor's stored
    /// numbers where the equations have another matrix since: such steps only tell whether the old factor still serves.
    pub(crate) fn substitute(&mut self) -> Option<Step> {
        self.oppose_gradient();
        let Self { factor, equations, pattern, step, phases, .. } = self;
        let matrix = self.is_factorised.then(|| equations.damped(self.damping));
        timed(&mut phases.substitution, || {
            let Some(matrix) = matrix else {
                factor.precondition(&pattern.symbolic, step);
                return Ok(());
            };
            factor.solve(&pattern.symbolic, &pattern.pairs, matrix, step)
        })
        .ok()?;
        self.full_step()
    }

    /// Makes the step the negative gradient.
    pub(super) fn oppose_gradient(&mut self) {
        for (step, gradient) in self.step.iter_mut().zip(&self.equations.gradient) {
            *step = -gradient;
        }
    }

    /// What the model says about the full step in `self.step`; `None` if it is not finite.
    pub(super) fn full_step(&self) -> Option<Step> {
        let mut promised = 0.0;
        let mut largest = 0.0_f64;
        for (step, gradient) in self.step.iter().zip(&self.equations.gradient) {
            promised -= gradient.dot(step);
            largest = largest.max(self.magnitude.largest(step.iter(), translations(DOF)));
        }
        (promised.is_finite() && largest.is_finite()).then_some(Step { promised, largest })
    }

    /// Sets the trial to the poses moved apart by the step.
    pub(crate) fn retract(&mut self, poses: &[G]) {
        self.retract_by(poses, retract);
    }

    /// Sets the trial to the poses moved along screws by the step.
    pub(super) fn retract_by_screws(&mut self, poses: &[G]) {
        self.retract_by(poses, retract_by_screws);
    }

    fn retract_by(&mut self, poses: &[G], retract: fn(&[G], &[SVector<f64, DOF>], &mut [G])) {
        let Self { trial, step, pattern, phases, .. } = self;
        timed(&mut phases.linearisation, || {
            trial.resize(poses.len(), G::identity());
            let (held, free) = poses.split_at(pattern.held);
            trial[..held.len()].copy_from_slice(held);
            retract(free, step, &mut trial[held.len()..]);
        });
    }

    /// Assembles the equations at these poses and returns the cost.
    pub(crate) fn assemble<T: Term<G, DOF>>(&mut self, edges: &[T], poses: &[G]) -> f64 {
        self.is_factorised = false;
        let Self { equations, pattern, phases, priors, .. } = self;
        timed(&mut phases.linearisation, || {
            let cost = equations.assemble(pattern, edges, poses);
            equations.add_priors(pattern.held, priors, poses, cost)
        })
    }

    /// Computes only the gradient and the cost; the matrix stays the same.
    pub(crate) fn assemble_gradient<T: Term<G, DOF>>(&mut self, edges: &[T], poses: &[G]) -> f64 {
        let Self { equations, pattern, phases, priors, .. } = self;
        timed(&mut phases.linearisation, || {
            let cost = equations.assemble_gradient(pattern, edges, poses);
            equations.add_prior_gradients(pattern.held, priors, poses, cost)
        })
    }

    /// Computes the gradient and the cost at the trial; the matrix stays the same.
    pub(crate) fn trial_gradient<T: Term<G, DOF>>(&mut self, edges: &[T]) -> f64 {
        self.at_trial(|workspace, trial| workspace.assemble_gradient(edges, trial))
    }

    /// Assembles the equations at the trial and returns the cost.
    pub(crate) fn trial_equations<T: Term<G, DOF>>(&mut self, edges: &[T]) -> f64 {
        self.at_trial(|workspace, trial| workspace.assemble(edges, trial))
    }

    fn at_trial(&mut self, assemble: impl FnOnce(&mut Self, &[G]) -> f64) -> f64 {
        let trial = std::mem::take(&mut self.trial);
        let cost = assemble(self, &trial);
        self.trial = trial;
        cost
    }

    /// The cost at the trial.
    pub(crate) fn trial_cost<T: Term<G, DOF>>(&mut self, edges: &[T]) -> f64 {
        let Self { trial, phases, priors, .. } = self;
        timed(&mut phases.linearisation, || {
            let of_edges = total(edges, trial);
            if priors.is_empty() { of_edges } else { of_edges + prior::cost(priors, trial) }
        })
    }

    /// The cost that rounding errors alone may cause at these poses.
    pub(crate) fn rounding<T: Term<G, DOF>>(&self, edges: &[T], poses: &[G]) -> f64 {
        let of_edges: f64 = edges.iter().map(|edge| edge.rounding(poses)).sum();
        self.priors.iter().fold(of_edges, |sum, prior| sum + prior.rounding(&poses[prior.node]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::problem::{Edge, EdgeKind};
    use crate::options::{Method, Options};
    use posecut_geometry::{LieGroup, SE3};

    /// A helix of 200 poses with an edge to the turn before, and errors of up to so many metres and radians.
    fn helix(largest: f64) -> (Vec<SE3>, Vec<Edge<SE3, 6>>) {
        let step = SE3::exp(&SVector::from([1.0, 0.0, 0.05, 0.0, 0.0, 0.3]));
        let mut truth = vec![SE3::identity()];
        for node in 1..200 {
            truth.push(truth[node - 1].compose(&step));
        }
        let error = |seed: usize| SVector::from_fn(|axis, _| largest * ((seed * 7 + axis * 13) as f64).sin());
        let information = SMatrix::from_diagonal(&SVector::from([400.0, 400.0, 100.0, 1e4, 1e4, 1e4]));
        let edge = |from: usize, to: usize, kind| {
            let measured =
                truth[from].inverse().compose(&truth[to]).compose(&SE3::exp(&error(from * 3 + to)));
            Edge::new(from, to, measured, information, kind)
        };
        let mut edges: Vec<_> = (1..200).map(|to| edge(to - 1, to, EdgeKind::Odometry)).collect();
        edges.extend((21..200).map(|to| edge(to - 21, to, EdgeKind::Landmark)));
        let mut start = vec![SE3::identity()];
        for node in 1..200 {
            start.push(start[node - 1].compose(&edges[node - 1].measurement));
        }
        (start, edges)
    }

    /// Very large factors are stored in single precision; here a small one is, so that the descent goes through every use of it.
    #[test]
    fn a_factor_stored_in_single_precision_leads_to_the_same_minimum() {
        let (start, edges) = helix(0.03);
        let pattern = Pattern::of(start.len(), 1, &edges);
        for method in [Method::LevenbergMarquardt, Method::Dogleg, Method::GaussNewton] {
            let options = Options { method, ..Options::default() };
            let descend = |is_single: bool| {
                let mut workspace = Workspace::new(&pattern, Magnitude::of(edges.iter()), Memory::default());
                if is_single {
                    workspace.factor = MixedFactor::single(&pattern.symbolic);
                }
                let mut poses = start.clone();
                let outcome = workspace.minimise(&edges, &mut poses, &options);
                assert_eq!(workspace.factor.is_single(), is_single);
                assert!(outcome.termination.converged());
                (outcome.cost, outcome.factorizations)
            };
            let ((single, count), (double, other)) = (descend(true), descend(false));
            assert!((single / double - 1.0).abs() < 1e-9, "{method:?}: {single} {double}");
            assert_eq!(count, other, "{method:?}");
        }
    }

    /// Steps by conjugate gradients are for very large graphs; here a small one takes them, too. Every one saves a factorisation.
    #[test]
    fn steps_by_conjugate_gradients_lead_to_the_same_minimum() {
        let (start, edges) = helix(0.2);
        let pattern = Pattern::of(start.len(), 1, &edges);
        let descend = |iterations: usize| {
            let mut workspace = Workspace::new(&pattern, Magnitude::of(edges.iter()), Memory::default());
            workspace.conjugate_iterations = iterations;
            let mut poses = start.clone();
            let outcome = workspace.minimise(&edges, &mut poses, &Options::default());
            assert!(outcome.termination.converged());
            (outcome.cost, outcome.factorizations)
        };
        let ((cost, count), (expected, most)) = (descend(20), descend(0));
        println!("{cost} by {count} factorisations, {expected} by {most}");
        assert!((cost / expected - 1.0).abs() < 1e-9 && count < most);
        // Steps that give up change nothing.
        assert_eq!(descend(1), (expected, most));
    }
}

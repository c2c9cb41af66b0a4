//! The map of the accepted closures, and its evidence for each closure.

use std::sync::{Mutex, MutexGuard, PoisonError};

use nalgebra::{SMatrix, SVector};
use posecut_graph::PoseGraph;
use posecut_optimize::{
    Edge, EdgeKind, Initialisation, Marginals, Memory, Options, Problem, optimize_with_marginals,
};
use rayon::prelude::*;

use crate::calibration::Calibration;
use crate::evidence::{CLIP, Evidence, chi_square_quantile, compare};
use crate::model::{Model, Motion};
use crate::partners::Partners;
use crate::rounds::CONTRADICTED;
use crate::translation::translation_part;

/// Closures without an accepted neighbour whose covariance is computed exactly in one round. Each costs a triangular solve.
const EXACT: usize = 400;
/// The largest scale of the map's own errors. The smallest is one, because the middle of the innovations may be better than
/// their covariances say while the tails are longer.
const SCALE_MOST: f64 = 30.0;
/// Smallest share of a measurement's variance that must remain after subtracting the map's. With less, the rest of the map
/// cannot judge the measurement.
const SHARE_LEFT: f64 = 1e-8;

/// All that the optimiser needs from a graph, read once.
pub(crate) struct Drawing<G, const DOF: usize> {
    start: Vec<G>,
    odometry: Vec<(usize, Edge<G, DOF>)>,
    landmarks: Vec<Edge<G, DOF>>,
    /// The covariance of each landmark edge's measurement, as claimed.
    covariances: Vec<SMatrix<f64, DOF, DOF>>,
    /// The part of each that is translation with the right heading.
    translations: Vec<SMatrix<f64, DOF, DOF>>,
    /// Memory of the last map, for the next one.
    memory: Mutex<Vec<Memory>>,
}

/// Optimised poses and their covariances.
pub(crate) struct Map<'a, G, const DOF: usize> {
    drawing: &'a Drawing<G, DOF>,
    model: &'a Model<G, DOF>,
    calibration: &'a Calibration,
    accepted: &'a [bool],
    pub(crate) poses: Vec<G>,
    marginals: Marginals<G, DOF>,
    /// Factor on covariances, estimated from the innovations of accepted closures.
    pub(crate) scale: f64,
    /// Evidence above which a closure is accepted.
    pub(crate) enough: f64,
    /// The second moment of relative poses by chance; `None` takes that of a closure's own chains.
    pub(crate) apart: Option<SMatrix<f64, DOF, DOF>>,
}

/// How a measurement differs from what the rest of the map predicts.
#[derive(Clone, Copy)]
struct Innovation<const DOF: usize> {
    error: SVector<f64, DOF>,
    covariance: SMatrix<f64, DOF, DOF>,
}

impl<G: Motion<DOF>, const DOF: usize> Drawing<G, DOF> {
    pub(crate) fn of(graph: &PoseGraph, model: &Model<G, DOF>) -> anyhow::Result<Self> {
        let measured = posecut_optimize::pose_graph::edges::<G, DOF>(graph)?;
        let mut landmark_of = vec![None; graph.edges.len()];
        let mut odometry = Vec::new();
        for (edge, &place) in measured.edges.iter().zip(&measured.places) {
            match edge.kind {
                EdgeKind::Odometry => odometry.push((model.chains.places[edge.from].0, *edge)),
                EdgeKind::Landmark => landmark_of[place] = Some(*edge),
            }
        }
        let landmarks: Vec<_> =
            model.closures.iter().filter_map(|closure| landmark_of[closure.candidate.edge]).collect();
        let covariances: Vec<_> =
            model.closures.iter().map(|closure| model.measurement_covariance(closure)).collect();
        let place = |&(chain, place): &(usize, usize)| model.chains.chains[chain].poses[place];
        Ok(Self {
            start: model.chains.places.iter().map(place).collect(),
            odometry,
            landmarks,
            translations: covariances.iter().map(translation_part).collect(),
            covariances,
            memory: Mutex::default(),
        })
    }

    /// The edge of a closure.
    pub(crate) fn landmark(&self, closure: usize) -> &Edge<G, DOF> {
        &self.landmarks[closure]
    }

    /// Optimises the odometry, the accepted closures, and bridges where odometry is missing.
    pub(crate) fn map<'a>(
        &'a self,
        model: &'a Model<G, DOF>,
        calibration: &'a Calibration,
        accepted: &'a [bool],
        bridges: &[Edge<G, DOF>],
        start: Option<&[G]>,
    ) -> anyhow::Result<Map<'a, G, DOF>> {
        let odometry = self.odometry.iter().map(|(chain, edge)| Edge {
            information: edge.information / calibration.odometry[*chain],
            ..*edge
        });
        let landmarks = self
            .landmarks
            .iter()
            .zip(accepted)
            .filter(|(_, accepted)| **accepted)
            .map(|(edge, _)| Edge { information: edge.information / calibration.landmark, ..*edge });
        let initialisation = if start.is_some() { Initialisation::Given } else { Initialisation::Best };
        let start = start.unwrap_or(&self.start).to_vec();
        let problem =
            Problem::new(start, odometry.chain(bridges.iter().copied()).chain(landmarks).collect())?;
        // The tolerance is the usual one: without an edge that alone holds two parts, what its residual is off the minimum would grow by the
        // inverse of the share of its variance that is left.
        let options = Options { max_iterations: 40, initialisation, ..Options::default() };
        let memory = std::mem::take(&mut *self.memory());
        let (solution, marginals) = optimize_with_marginals(&problem, &options, memory);
        let poses = solution.poses;
        Ok(Map {
            drawing: self,
            model,
            calibration,
            accepted,
            poses,
            marginals,
            scale: 1.0,
            enough: CLIP,
            apart: None,
        })
    }
}

impl<G, const DOF: usize> Drawing<G, DOF> {
    fn memory(&self) -> MutexGuard<'_, Vec<Memory>> {
        // Memory has no values, so a panic elsewhere cannot have spoilt it.
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<G: Motion<DOF>, const DOF: usize> Map<'_, G, DOF> {
    /// Returns the poses, and keeps the memory for the next map.
    pub(crate) fn finish(self) -> Vec<G> {
        *self.drawing.memory() = self.marginals.into_memory();
        self.poses
    }

    /// Evidence for every closure in `asked`, leaving out its own contribution to the map. Closures in `first` are judged
    /// exactly before others. `None` where nothing else joins both ends, or where the exact computation exceeds this round's
    /// limit.
    pub(crate) fn judge(
        &mut self,
        partners: &Partners,
        asked: &[usize],
        first: &[usize],
    ) -> Vec<Option<Evidence>> {
        let members: Vec<usize> = asked.iter().copied().filter(|&closure| self.accepted[closure]).collect();
        let mut found: Vec<Option<Innovation<DOF>>> = vec![None; self.accepted.len()];
        let posterior = self.relative(&members);
        let mut held: Vec<Option<SMatrix<f64, DOF, DOF>>> = vec![None; self.accepted.len()];
        let own = members
            .par_iter()
            .zip(&posterior)
            .map(|(&member, covariance)| covariance.and_then(|covariance| self.without(member, &covariance)));
        for (&member, innovation) in members.iter().zip(own.collect::<Vec<_>>()) {
            found[member] = innovation;
        }
        for (&member, covariance) in members.iter().zip(posterior) {
            held[member] = covariance;
        }
        self.scale = spread(members.iter().filter_map(|&member| found[member]));
        self.neighbours(partners, asked, &held, &mut found);
        self.exactly(asked, first, &mut found);
        let map = &*self;
        asked
            .par_iter()
            .map(|&closure| found[closure].and_then(|innovation| map.evidence(closure, &innovation)))
            .collect()
    }

    /// The squared distance between a motion outside the map and the map's prediction; `None` where the map does not join its
    /// ends.
    pub(crate) fn distance(&mut self, motion: &Edge<G, DOF>) -> Option<f64> {
        let predicted = self.marginals.relative(&[(motion.from, motion.to)])[0]?;
        let error =
            motion.measurement.between(&self.poses[motion.from].between(&self.poses[motion.to])).log();
        let covariance =
            motion.information.cholesky()?.inverse() + carried::<G, DOF>(&error, &predicted) * self.scale;
        Some(error.dot(&covariance.cholesky()?.solve(&error)))
    }

    /// Bounds the covariance of closures near an accepted one, from its relative pose in the map and the odometry between both.
    fn neighbours(
        &self,
        partners: &Partners,
        asked: &[usize],
        held: &[Option<SMatrix<f64, DOF, DOF>>],
        found: &mut [Option<Innovation<DOF>>],
    ) {
        let near = |closure: usize| {
            let neighbour = partners.near(closure).iter().find(|&&other| held[other].is_some())?;
            let between = self.model.between(*neighbour, closure, &held[*neighbour]?, self.calibration);
            Some(self.innovation(closure, &between))
        };
        let others: Vec<usize> = asked.iter().copied().filter(|&closure| !self.accepted[closure]).collect();
        let innovations: Vec<_> = others.par_iter().map(|&closure| near(closure)).collect();
        for (closure, innovation) in others.into_iter().zip(innovations) {
            found[closure] = innovation.or(found[closure]);
        }
    }

    /// Judges the remaining closures: by a bound where this already contradicts them, else by exact covariances, up to the
    /// limit of a round.
    fn exactly(&mut self, asked: &[usize], first: &[usize], found: &mut [Option<Innovation<DOF>>]) {
        let open: Vec<usize> = asked
            .iter()
            .copied()
            .filter(|&closure| !self.accepted[closure] && self.in_doubt(closure, found[closure].as_ref()))
            .collect();
        let mut nodes: Vec<usize> = open.iter().flat_map(|&closure| self.ends(closure)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let covariances = self.marginals.poses(&nodes);
        let of = |node: usize| nodes.binary_search(&node).ok().and_then(|place| covariances[place]);
        let mut unsure = Vec::new();
        for &closure in &open {
            let [from, to] = self.ends(closure);
            let (Some(start), Some(end)) = (of(from), of(to)) else { continue };
            // Cov(a - b) is at most 2 (Cov(a) + Cov(b)), whatever their correlation.
            let carry = self.poses[to].between(&self.poses[from]).adjoint();
            let bound = (carry * start * carry.transpose() + end) * 2.0;
            let innovation = self.innovation(closure, &bound);
            match self.evidence(closure, &innovation) {
                Some(evidence) if evidence.distant() < 0.0 => found[closure] = Some(innovation),
                _ => unsure.push(closure),
            }
        }
        let mut exact: Vec<usize> = first
            .iter()
            .copied()
            .filter(|closure| unsure.binary_search(closure).is_ok())
            .take(EXACT)
            .collect();
        let step = unsure.len().div_ceil(EXACT).max(1);
        exact.extend(unsure.iter().copied().step_by(step));
        exact.sort_unstable();
        exact.dedup();
        for (&closure, covariance) in exact.iter().zip(self.relative(&exact)) {
            found[closure] = covariance.map(|covariance| self.innovation(closure, &covariance));
        }
    }

    /// Whether a bound neither contradicts a closure nor supports it enough.
    fn in_doubt(&self, closure: usize, bound: Option<&Innovation<DOF>>) -> bool {
        let evidence = bound.and_then(|bound| self.evidence(closure, bound));
        evidence.is_none_or(|found| found.weight() > CONTRADICTED && found.weight() <= self.enough)
    }

    fn ends(&self, closure: usize) -> [usize; 2] {
        let edge = &self.drawing.landmarks[closure];
        [edge.from, edge.to]
    }

    /// Covariances of the relative poses of closures' ends.
    fn relative(&mut self, closures: &[usize]) -> Vec<Option<SMatrix<f64, DOF, DOF>>> {
        let pairs: Vec<(usize, usize)> =
            closures.iter().map(|&closure| self.ends(closure)).map(|[from, to]| (from, to)).collect();
        self.marginals.relative(&pairs)
    }

    fn own(&self, closure: usize) -> SMatrix<f64, DOF, DOF> {
        self.drawing.covariances[closure] * self.calibration.landmark
    }

    fn residual(&self, closure: usize) -> SVector<f64, DOF> {
        let edge = &self.drawing.landmarks[closure];
        edge.measurement.between(&self.poses[edge.from].between(&self.poses[edge.to])).log()
    }

    fn innovation(&self, closure: usize, predicted: &SMatrix<f64, DOF, DOF>) -> Innovation<DOF> {
        let error = self.residual(closure);
        Innovation { error, covariance: self.own(closure) + carried::<G, DOF>(&error, predicted) }
    }

    /// The innovation of a measurement that takes part in the map, for the map without it. With S the measurement's
    /// covariance, P the posterior covariance and r the residual, it is S (S - P)^-1 r, of covariance S (S - P)^-1 S.
    fn without(&self, closure: usize, posterior: &SMatrix<f64, DOF, DOF>) -> Option<Innovation<DOF>> {
        let (own, residual) = (self.own(closure), self.residual(closure));
        let left = own - carried::<G, DOF>(&residual, posterior);
        let left = (left + left.transpose()) * 0.5;
        let held = (0..DOF).all(|axis| left[(axis, axis)] >= SHARE_LEFT * own[(axis, axis)]);
        let Some(inverse) = left.cholesky().filter(|_| held).map(|cholesky| cholesky.inverse()) else {
            // The residual's squared distance under S is less than the innovation's, so it is enough if it already contradicts.
            let bound = Innovation { error: residual, covariance: own };
            return self
                .evidence(closure, &bound)
                .filter(|found| found.distant() <= CONTRADICTED)
                .map(|_| bound);
        };
        let gain = own * inverse;
        let covariance = gain * own;
        Some(Innovation { error: gain * residual, covariance: (covariance + covariance.transpose()) * 0.5 })
    }

    fn evidence(&self, closure: usize, innovation: &Innovation<DOF>) -> Option<Evidence> {
        let Drawing { covariances, translations, .. } = self.drawing;
        let local = self.calibration.local(&covariances[closure], &translations[closure]) * self.scale;
        compare(
            &innovation.error,
            &(innovation.covariance * self.scale),
            &self.apart.unwrap_or_else(|| self.model.apart_local(closure)),
            &local,
            self.calibration.tail,
        )
    }
}

/// The median squared distance of innovations over that of chi-square.
fn spread<const DOF: usize>(innovations: impl Iterator<Item = Innovation<DOF>>) -> f64 {
    let mut distances: Vec<f64> = innovations
        .filter_map(|innovation| {
            let cholesky = innovation.covariance.cholesky()?;
            Some(innovation.error.dot(&cholesky.solve(&innovation.error)))
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    let median = distances.get(distances.len() / 2);
    median.map_or(1.0, |median| (median / chi_square_quantile(DOF, 0.0)).clamp(1.0, SCALE_MOST))
}

/// The covariance of Log(Z^-1 X), given that of a right perturbation of X, also at large errors.
fn carried<G: Motion<DOF>, const DOF: usize>(
    error: &SVector<f64, DOF>,
    covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    let jacobian = G::right_jacobian_inverse(error);
    jacobian * covariance * jacobian.transpose()
}

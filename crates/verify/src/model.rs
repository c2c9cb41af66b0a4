//! Chains, candidates and the loops that they close.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::{SE2, SE3};
use posecut_graph::PoseGraph;
use posecut_optimize::PoseGroup;
use posecut_pcm::candidate::{Candidate, Group, group_with};
use posecut_pcm::chain::{Chain, Chains, Covariances};
use posecut_pcm::{PcmError, Spatial};

use crate::calibration::Calibration;
use crate::chance::{SHIFT, second_moment};
use crate::ingredients::Ingredient;
use crate::translation::translation_of;
use crate::verification::{self, Verification};

/// Groups of motions that can be judged: SE(2) and SE(3).
pub trait Motion<const DOF: usize>: Spatial<DOF> + PoseGroup<DOF> {
    /// The body of [`verify_by`](crate::verify_by): compiled here once for each group, and not again in every crate that calls the
    /// generic function.
    #[doc(hidden)]
    fn verify(graph: &PoseGraph, hypothesis: usize, without: &[Ingredient]) -> anyhow::Result<Verification>;
}

impl Motion<3> for SE2 {
    fn verify(graph: &PoseGraph, hypothesis: usize, without: &[Ingredient]) -> anyhow::Result<Verification> {
        verification::run::<Self, 3>(graph, hypothesis, without)
    }
}

impl Motion<6> for SE3 {
    fn verify(graph: &PoseGraph, hypothesis: usize, without: &[Ingredient]) -> anyhow::Result<Verification> {
        verification::run::<Self, 6>(graph, hypothesis, without)
    }
}

/// Directions of coherent odometry errors: along the motion, and across it (one direction in the plane, two in space).
pub(crate) const COHERENT: usize = 3;
type Drift<const DOF: usize> = SMatrix<f64, DOF, COHERENT>;

/// A landmark edge to judge.
#[derive(Clone, Debug)]
pub(crate) struct Closure<G, const DOF: usize> {
    pub(crate) group: usize,
    /// Whether the edge leads from chain A to chain B, which is the direction of the candidate.
    pub(crate) forward: bool,
    pub(crate) candidate: Candidate<G, DOF>,
    /// The part of its covariance that is translation with the right heading, in the frame of chain B.
    translation: SMatrix<f64, DOF, DOF>,
}

impl<G: Motion<DOF>, const DOF: usize> Closure<G, DOF> {
    fn of(group: usize, forward: bool, candidate: Candidate<G, DOF>, chain_b: &Chain<G, DOF>) -> Self {
        let translation = translation_of(&candidate, chain_b);
        Self { group, forward, candidate, translation }
    }
}

/// The chains that a group's candidates join, and the range of these candidates among all closures.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    pub(crate) a: usize,
    pub(crate) b: usize,
    pub(crate) first: usize,
    pub(crate) end: usize,
}

/// A pose graph as chains and closures.
pub(crate) struct Model<G, const DOF: usize> {
    pub(crate) chains: Chains<G, DOF>,
    /// The graph's node at each position of each chain.
    nodes: Vec<Vec<usize>>,
    /// Prefix sums over each chain of Ad(P_k) (m_k, 0), where m_k is the step's translation turned into each coherent direction.
    drifts: Vec<Vec<Drift<DOF>>>,
    /// For each chain, the second moment of the relative pose of two positions anywhere on it.
    apart: Vec<SMatrix<f64, DOF, DOF>>,
    pub(crate) groups: Vec<Group<G, DOF>>,
    pub(crate) spans: Vec<Span>,
    pub(crate) closures: Vec<Closure<G, DOF>>,
    pub(crate) unmeasured: usize,
    pub(crate) rejected_before: usize,
    without: Vec<Ingredient>,
}

/// A loop: its error, and the terms of its covariance, in the frame of chain B.
#[derive(Clone, Debug)]
pub(crate) struct Loop<const DOF: usize> {
    pub(crate) error: SVector<f64, DOF>,
    pub(crate) landmark: SMatrix<f64, DOF, DOF>,
    /// The part of it that is translation with the right heading.
    pub(crate) translation: SMatrix<f64, DOF, DOF>,
    /// For each chain, its number and the covariances from its random and its coherent odometry errors, at factors of one.
    pub(crate) odometry: [(usize, SMatrix<f64, DOF, DOF>, SMatrix<f64, DOF, DOF>); 2],
    /// R, the second moment of the error by chance.
    pub(crate) apart: SMatrix<f64, DOF, DOF>,
    /// The second moment of the error of a loop through a shifted closure, or through wrong neighbours.
    pub(crate) beside: SMatrix<f64, DOF, DOF>,
}

impl<G: Motion<DOF>, const DOF: usize> Model<G, DOF> {
    pub(crate) fn of(graph: &PoseGraph, without: &[Ingredient]) -> Result<Self, PcmError> {
        let chains = Chains::with(graph, Covariances::Repaired)?;
        let grouped = group_with(graph, &chains, Covariances::Repaired)?;
        let mut nodes: Vec<Vec<usize>> =
            chains.chains.iter().map(|chain| vec![0; chain.poses.len()]).collect();
        for (node, &(chain, place)) in chains.places.iter().enumerate() {
            nodes[chain][place] = node;
        }
        let drifts = chains.chains.iter().map(|chain| drift(chain)).collect();
        let apart = chains.chains.iter().map(|chain| second_moment(&chain.poses)).collect();
        let (mut spans, mut closures) = (Vec::new(), Vec::new());
        for (number, group) in grouped.groups.iter().enumerate() {
            let first = closures.len();
            closures.extend(group.candidates.iter().map(|candidate| {
                let edge = &graph.edges[candidate.edge];
                let place = |node| graph.node_index(node).map(|node| chains.places[node]);
                let forward = place(edge.from) <= place(edge.to);
                Closure::of(number, forward, candidate.clone(), &chains.chains[group.b])
            }));
            spans.push(Span { a: group.a, b: group.b, first, end: closures.len() });
        }
        Ok(Self {
            chains,
            nodes,
            drifts,
            apart,
            groups: grouped.groups,
            spans,
            closures,
            unmeasured: grouped.unmeasured,
            rejected_before: grouped.rejected_before,
            without: without.to_vec(),
        })
    }

    /// The graph's node at a position of a chain.
    pub(crate) fn node(&self, chain: usize, place: usize) -> usize {
        self.nodes[chain][place]
    }

    /// Whether the caller switched this ingredient of the method off.
    pub(crate) fn without(&self, ingredient: Ingredient) -> bool {
        self.without.contains(&ingredient)
    }

    /// The covariance of a closure's measurement, as a right perturbation at the node that its edge leads to.
    pub(crate) fn measurement_covariance(&self, closure: &Closure<G, DOF>) -> SMatrix<f64, DOF, DOF> {
        let candidate = &closure.candidate;
        let chain = self.chain(self.spans[closure.group].b);
        let back = chain.poses[candidate.k].inverse().adjoint();
        let forward = back * candidate.covariance * back.transpose();
        if closure.forward {
            return forward;
        }
        // The candidate is the inverse of the edge, because candidates lead from chain A to chain B.
        let chain_a = self.chain(self.spans[closure.group].a);
        let measured = chain_a.poses[candidate.i]
            .inverse()
            .compose(&candidate.alignment)
            .compose(&chain.poses[candidate.k]);
        let turn = measured.adjoint();
        turn * forward * turn.transpose()
    }

    /// A bound on the covariance of the relative pose of a closure's ends, from the covariance of a neighbour's ends and the
    /// odometry between the two closures.
    pub(crate) fn between(
        &self,
        neighbour: usize,
        closure: usize,
        held: &SMatrix<f64, DOF, DOF>,
        calibration: &Calibration,
    ) -> SMatrix<f64, DOF, DOF> {
        let closed = self.pair(neighbour, closure);
        let mut sum = SMatrix::zeros();
        for (chain, random, _) in &closed.odometry {
            sum += random * calibration.odometry[*chain];
        }
        // From the frame of chain B to that of the node that the edge leads to.
        let span = self.span(closure);
        let local = |candidate: &Candidate<G, DOF>, forward: bool| {
            if forward {
                self.chain(span.b).poses[candidate.k].inverse().adjoint()
            } else {
                self.chain(span.a).poses[candidate.i].inverse().compose(&candidate.alignment).adjoint()
            }
        };
        let (one, other) = (&self.closures[neighbour], &self.closures[closure]);
        let from_neighbour = local(&one.candidate, one.forward)
            .try_inverse()
            .map_or_else(SMatrix::zeros, |back| back * held * back.transpose());
        let to_closure = local(&other.candidate, other.forward);
        to_closure * (sum + from_neighbour) * to_closure.transpose()
    }

    /// The number of the two chains that a closure joins.
    pub(crate) fn group(&self, closure: usize) -> usize {
        self.closures[closure].group
    }

    pub(crate) fn span(&self, closure: usize) -> &Span {
        &self.spans[self.group(closure)]
    }

    /// Chain and position of a closure's ends: first in chain A, then in chain B.
    pub(crate) fn ends(&self, closure: usize) -> [(usize, usize); 2] {
        let (span, candidate) = (self.span(closure), &self.closures[closure].candidate);
        [(span.a, candidate.i), (span.b, candidate.k)]
    }

    pub(crate) fn same_chain(&self, closure: usize) -> bool {
        let span = self.span(closure);
        span.a == span.b
    }

    /// R at the closure's position in chain B, in the frame of that chain.
    fn apart_at(&self, closure: usize) -> SMatrix<f64, DOF, DOF> {
        let span = self.span(closure);
        let local = (self.apart[span.a] + self.apart[span.b]) * 0.5;
        let adjoint = self.end(closure).adjoint();
        adjoint * local * adjoint.transpose()
    }

    /// The pose of a closure's end in chain B, in that chain's frame.
    pub(crate) fn end(&self, closure: usize) -> G {
        self.chain(self.span(closure).b).poses[self.closures[closure].candidate.k]
    }

    /// R in the frame of the closure's position itself.
    pub(crate) fn apart_local(&self, closure: usize) -> SMatrix<f64, DOF, DOF> {
        let span = self.span(closure);
        (self.apart[span.a] + self.apart[span.b]) * 0.5
    }

    fn chain(&self, number: usize) -> &Chain<G, DOF> {
        &self.chains.chains[number]
    }

    /// The loop through two closures of one group and the odometry between them (Mangelson et al., equation 6, conjugated
    /// into the frame of chain B): E = T_a^-1 T_b.
    pub(crate) fn pair(&self, one: usize, other: usize) -> Loop<DOF> {
        self.pair_of(&self.closures[one], &self.closures[other], one)
    }

    /// The same loop, with the second closure's end in chain B moved to that of a third closure.
    pub(crate) fn pair_shuffled(&self, one: usize, other: usize, third: usize) -> Loop<DOF> {
        self.pair_of(&self.closures[one], &self.shuffled(other, third), one)
    }

    /// A closure moved to another closure's end in chain B. It keeps its measurement, which is meaningless there.
    fn shuffled(&self, closure: usize, donor: usize) -> Closure<G, DOF> {
        let span = self.span(closure);
        let (own, donor) = (&self.closures[closure].candidate, &self.closures[donor].candidate);
        let (chain_a, chain_b) = (self.chain(span.a), self.chain(span.b));
        let measurement =
            chain_a.poses[own.i].inverse().compose(&own.alignment).compose(&chain_b.poses[own.k]);
        let back = chain_b.poses[own.k].inverse().adjoint();
        let covariance = back * own.covariance * back.transpose();
        let moved = Candidate::new(own.edge, (chain_a, own.i), (chain_b, donor.k), &measurement, &covariance);
        let Closure { group, forward, .. } = self.closures[closure];
        Closure::of(group, forward, moved, chain_b)
    }

    /// The loop through a closure and another measurement between nodes of the same two chains. The second result is the
    /// covariance of that measurement, which the loop's own terms do not include.
    pub(crate) fn beside(
        &self,
        closure: usize,
        [from, to]: [usize; 2],
        measurement: &G,
        covariance: &SMatrix<f64, DOF, DOF>,
    ) -> (Loop<DOF>, SMatrix<f64, DOF, DOF>) {
        let (from, to) = (self.chains.places[from], self.chains.places[to]);
        let turned = measurement.adjoint();
        let (start, end, measurement, covariance) = if from.0 == self.span(closure).a {
            (from, to, *measurement, *covariance)
        } else {
            (to, from, measurement.inverse(), turned * covariance * turned.transpose())
        };
        let own = &self.closures[closure];
        let (a, b) = ((self.chain(start.0), start.1), (self.chain(end.0), end.1));
        let other = Candidate::new(own.candidate.edge, a, b, &measurement, &covariance);
        let other = Closure::of(own.group, true, other, b.0);
        let mut closed = self.pair_of(&other, own, closure);
        closed.landmark = own.candidate.covariance;
        closed.translation = own.translation;
        (closed, other.candidate.covariance)
    }

    fn pair_of(&self, one: &Closure<G, DOF>, other: &Closure<G, DOF>, closure: usize) -> Loop<DOF> {
        let (a, b) = (&one.candidate, &other.candidate);
        let translation = one.translation + other.translation;
        let span = self.span(closure);
        let (chain_a, chain_b) = (self.chain(span.a), self.chain(span.b));
        let to_b = a.to_b;
        let error = a.from_a.compose(&b.alignment).log();
        let landmark = a.covariance + b.covariance;
        let (drift_a, drift_b) = (
            self.drifts[span.a][b.i] - self.drifts[span.a][a.i],
            self.drifts[span.b][b.k] - self.drifts[span.b][a.k],
        );
        let zero = SMatrix::zeros();
        let odometry = if span.a == span.b {
            // Both stretches may share steps. Errors of shared steps act through both, so add their cross terms with the sign.
            let first = a.i.min(b.i).max(a.k.min(b.k));
            let last = a.i.max(b.i).min(a.k.max(b.k));
            let mut sum = to_b * chain_a.covariance_between(a.i, b.i) * to_b.transpose()
                + chain_b.covariance_between(a.k, b.k);
            if first < last {
                let steps = chain_a.covariance_between(first, last);
                let sign = if (a.i < b.i) == (a.k < b.k) { -1.0 } else { 1.0 };
                let cross = to_b * steps * sign;
                sum += cross + cross.transpose();
            }
            let drift = to_b * drift_a - drift_b;
            [(span.a, sum, drift * drift.transpose()), (span.b, zero, zero)]
        } else {
            let drift_a = to_b * drift_a;
            let along_a = to_b * chain_a.covariance_between(a.i, b.i) * to_b.transpose();
            [
                (span.a, along_a, drift_a * drift_a.transpose()),
                (span.b, chain_b.covariance_between(a.k, b.k), drift_b * drift_b.transpose()),
            ]
        };
        let apart = self.apart_at(closure);
        Loop { error, landmark, translation, odometry, apart, beside: apart * SHIFT }
    }

    /// The loop through one closure and the odometry of its own chain; `None` between two chains.
    pub(crate) fn single(&self, closure: usize) -> Option<Loop<DOF>> {
        self.same_chain(closure).then(|| self.single_of(&self.closures[closure], closure))
    }

    pub(crate) fn single_shuffled(&self, closure: usize, donor: usize) -> Option<Loop<DOF>> {
        self.same_chain(closure).then(|| self.single_of(&self.shuffled(closure, donor), closure))
    }

    fn single_of(&self, own: &Closure<G, DOF>, closure: usize) -> Loop<DOF> {
        let candidate = &own.candidate;
        let span = self.span(closure);
        let chain = self.chain(span.a);
        let drift = self.drifts[span.a][candidate.k] - self.drifts[span.a][candidate.i];
        let zero = SMatrix::zeros();
        let apart = self.apart_at(closure);
        Loop {
            error: candidate.from_a.log(),
            landmark: candidate.covariance,
            translation: own.translation,
            odometry: [
                (span.a, chain.covariance_between(candidate.i, candidate.k), drift * drift.transpose()),
                (span.b, zero, zero),
            ],
            apart,
            beside: apart * SHIFT,
        }
    }
}

fn drift<G: Motion<DOF>, const DOF: usize>(chain: &Chain<G, DOF>) -> Vec<Drift<DOF>> {
    let mut sum = Drift::zeros();
    let mut sums = vec![sum];
    for (before, after) in chain.poses.iter().zip(chain.poses.iter().skip(1)) {
        let [x, y, z] = before.between(after).translation();
        let mut steps = Drift::zeros();
        if DOF == 3 {
            (steps[(0, 0)], steps[(1, 0)]) = (x, y);
            (steps[(0, 1)], steps[(1, 1)]) = (-y, x);
        } else {
            (steps[(0, 0)], steps[(1, 0)], steps[(2, 0)]) = (x, y, z);
            (steps[(0, 1)], steps[(1, 1)]) = (-y, x);
            (steps[(0, 2)], steps[(2, 2)]) = (-z, x);
        }
        sum += after.adjoint() * steps;
        sums.push(sum);
    }
    sums
}

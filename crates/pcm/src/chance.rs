//! Agreement by chance: how many edges between random positions would agree as well as a given edge.
//!
//! This is the number of false alarms of an edge (a contrario: Desolneux, Moisan, Morel, IJCV 2000); [`Chance`] gives the
//! formula. `islands` splits the members of a set into connected components. Depends on odometry and pairs.

mod islands;

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use statrs::function::gamma::ln_gamma;

use crate::odometry::chain::{Chain, Chains};
use crate::odometry::spread::Spatial;
use crate::pairs::candidate::{Candidate, Group};
use crate::pairs::consistency::{Pairs, elsewhere};
use crate::pairs::distance::{loop_through, loop_through_odometry};
use crate::pairs::nearest::Nearest;
use islands::Islands;

/// The default cost of a wrong edge, in correct ones.
pub const COST: f64 = 3.0;
/// The number of candidates whose positions show how far apart two of them may be. More would not change the answer.
const SAMPLE: usize = 1000;
/// The most members that may be witnesses of an edge.
const WITNESSES: usize = 16;

/// Counts false alarms among the candidates of a group (a contrario: Desolneux, Moisan, Morel, IJCV 2000).
///
/// Across a long stretch of odometry nearly everything agrees. The error of an edge that joins two random positions is the
/// relative pose of these two. Its distribution is modelled as Gaussian; the second moment R is that of pairs of the
/// candidates' positions in chain B. Let d be the distance of a candidate from its witness. The probability that a random
/// edge agrees with the witness as well is the volume of the ellipsoid within d, times that density at its centre:
///
/// p = d^D / (2^(D/2) Gamma(D/2 + 1)) sqrt(|S| / |S + R|),    at most 1.
///
/// S is the covariance of the loop through both edges, D the number of degrees of freedom. If all N candidates were random,
/// N p of them would agree as well: this is the number of false alarms. The witness is the one of least |S| / |S + R|. This
/// choice does not use d, so that the numbers of random edges are distributed uniformly up to N.
pub struct Chance<'a, G, const DOF: usize> {
    pairs: &'a Pairs<'a, G, DOF>,
    pool: Pool<DOF>,
    /// ln Gamma(D/2 + 1)
    log_gamma: f64,
}

/// What the groups of a graph share: a group of few candidates is too small to show what agrees by chance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pool<const DOF: usize> {
    /// R, in the frame of a position of chain B.
    apart: SMatrix<f64, DOF, DOF>,
    /// N, over all groups, because false edges fall into any of them.
    candidates: usize,
    groups: usize,
}

impl<const DOF: usize> Pool<DOF> {
    /// O(1) a group: a thousand pairs of positions.
    pub(crate) fn of<G: Spatial<DOF>>(chains: &Chains<G, DOF>, groups: &[Group<G, DOF>]) -> Self {
        let places = groups.iter().map(|group| (&chains.chains[group.b], &group.candidates[..]));
        Self::of_places(places)
    }

    fn of_places<'a, G: Spatial<DOF>>(
        groups: impl Iterator<Item = (&'a Chain<G, DOF>, &'a [Candidate<G, DOF>])>,
    ) -> Self {
        let groups: Vec<_> = groups.collect();
        let step = |count: usize| count.div_ceil(SAMPLE).max(1);
        let sampled: usize = groups.iter().map(|(_, of)| of.len().div_ceil(step(of.len()))).sum();
        let mut pool = Self { apart: SMatrix::zeros(), candidates: 0, groups: groups.len() };
        for (chain_b, candidates) in groups {
            let count = candidates.len();
            let place = |candidate: usize| chain_b.poses[candidates[candidate].k];
            for (turn, one) in (0..count).step_by(step(count)).enumerate() {
                let error = place(one).between(&place(elsewhere(count, one, turn + 1))).log();
                pool.apart += error * error.transpose() / sampled as f64;
            }
            pool.candidates += count;
        }
        pool
    }
}

/// Which agreement is accepted: what a wrong edge costs, and which candidates count as N.
#[derive(Clone, Copy, Debug)]
pub struct Acceptance<const DOF: usize> {
    /// The cost of a wrong edge, in correct ones.
    pub cost: f64,
    pool: Option<Pool<DOF>>,
}

impl<const DOF: usize> Acceptance<DOF> {
    /// Counts the candidates of one group only.
    pub fn within_group(cost: f64) -> Self {
        Self { cost, pool: None }
    }

    /// Counts the candidates of all groups of the graph.
    pub(crate) fn within(cost: f64, pool: Option<Pool<DOF>>) -> Self {
        Self { cost, pool }
    }

    /// Prepares the count of false alarms for a group's candidates. O(1): a thousand pairs of positions.
    pub(crate) fn chance<'a, G: Spatial<DOF>>(&self, pairs: &'a Pairs<'a, G, DOF>) -> Chance<'a, G, DOF> {
        match self.pool {
            Some(pool) => Chance::among(pairs, pool),
            None => Chance::new(pairs),
        }
    }
}

/// Which members agree better than by chance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Support {
    /// Members that stay, ascending.
    pub supported: Vec<usize>,
    /// Members that agree no better than chance, ascending.
    pub by_chance: Vec<usize>,
    /// Each member with the false alarms that it would cause.
    pub false_alarms: Vec<(usize, f64)>,
}

/// What the loop through an edge and its witness shows.
#[derive(Clone, Copy)]
struct Evidence {
    /// |S| / |S + R|
    ratio: f64,
    squared_distance: f64,
}

/// The false alarms of a member: with its best witness, with the odometry, and with each member near it.
struct Vouched {
    false_alarms: f64,
    odometry: f64,
    near: Vec<(usize, f64)>,
}

impl<'a, G: Spatial<DOF>, const DOF: usize> Chance<'a, G, DOF> {
    /// Judges a group by itself. O(1): a thousand pairs of positions.
    pub fn new(pairs: &'a Pairs<'a, G, DOF>) -> Self {
        Self::among(pairs, Pool::of_places(std::iter::once((pairs.chain_b, pairs.candidates))))
    }

    fn among(pairs: &'a Pairs<'a, G, DOF>, pool: Pool<DOF>) -> Self {
        Self { pairs, pool, log_gamma: ln_gamma(0.5 * DOF as f64 + 1.0) }
    }

    /// The false alarms of an edge. Its witness is the best of these candidates or, within one chain, the odometry alone;
    /// without a witness the number is N. O(witnesses).
    pub fn false_alarms(&self, candidate: usize, witnesses: &[usize]) -> f64 {
        let all = witnesses.iter().map(|&witness| self.with(candidate, witness));
        self.count(best(all.chain([self.with_odometry(candidate)])))
    }

    fn with(&self, candidate: usize, witness: usize) -> Option<Evidence> {
        let (one, other) = (candidate.min(witness), candidate.max(witness));
        let (a, b) = (&self.pairs.candidates[one], &self.pairs.candidates[other]);
        let closed = loop_through(self.pairs.chain_a, self.pairs.chain_b, self.pairs.same_chain, a, b);
        self.evidence(&self.pairs.candidates[candidate], closed)
    }

    fn with_odometry(&self, candidate: usize) -> Option<Evidence> {
        if !self.pairs.same_chain {
            return None;
        }
        let candidate = &self.pairs.candidates[candidate];
        self.evidence(candidate, loop_through_odometry(self.pairs.chain_a, candidate))
    }

    /// `None` where a covariance is not positive definite.
    fn evidence(
        &self,
        candidate: &Candidate<G, DOF>,
        (error, covariance): (SVector<f64, DOF>, SMatrix<f64, DOF, DOF>),
    ) -> Option<Evidence> {
        // R is in the frame of the candidate's position, the loop's covariance S in that of chain B: the adjoint carries R
        // there.
        let to_chain = self.pairs.chain_b.poses[candidate.k].adjoint();
        let (near, far) = (
            covariance.cholesky()?,
            (covariance + to_chain * self.pool.apart * to_chain.transpose()).cholesky()?,
        );
        Some(Evidence {
            ratio: near.determinant() / far.determinant(),
            squared_distance: error.dot(&near.solve(&error)),
        })
    }

    fn count(&self, evidence: Option<Evidence>) -> f64 {
        // d^D / (2^(D/2) Gamma(D/2 + 1)) = exp(D/2 ln(d^2 / 2) - ln Gamma(D/2 + 1)), in logarithms because d^D overflows at
        // large d.
        let chance = evidence.map_or(1.0, |Evidence { ratio, squared_distance }| {
            (0.5 * DOF as f64 * (0.5 * squared_distance).ln() - self.log_gamma).exp() * ratio.sqrt()
        });
        self.pool.candidates as f64 * chance.min(1.0)
    }

    /// Divides members (ascending) into those that agree better than by chance and the others, where a wrong edge costs as
    /// much as `cost` correct ones.
    ///
    /// Two members support each other if the link between them causes no more false alarms than [`acceptable`] allows.
    /// Supported members grow from a first island of connected members: within one chain, the island that the odometry
    /// supports; between two chains, the largest island. Another island of m members joins if its best link causes at most
    /// m times as many false alarms, because N candidates form at most N / m such islands. In a graph with one group the
    /// first island always stays, even if it is a lone candidate. With several groups, a lone member without support is
    /// dropped: otherwise each group would keep one, and false edges spread over many groups. O(n log n), and as much again
    /// for each round in which islands join.
    pub fn support(&self, members: &[usize], cost: f64) -> Support {
        let nearest = Nearest::new(self.pairs, members);
        let vouched: Vec<Vouched> =
            members.par_iter().map(|&member| self.vouched(member, &nearest)).collect();
        let limit = acceptable(vouched.iter().map(|of| of.false_alarms).collect(), cost);
        let links: Vec<(bool, Vec<usize>)> = vouched
            .iter()
            .map(|of| {
                let linked = of.near.iter().filter(|&&(_, expected)| expected <= limit);
                (of.odometry <= limit, linked.map(|&(other, _)| other).collect())
            })
            .collect();
        // Islands are formed before members are judged: two overlaps far apart cannot support each other across the
        // odometry between them. Judged one by one, all members of the smaller overlap would look like chance.
        let mut islands = Islands::of(members, &links);
        let mut supported = islands.take_first();
        if self.pool.groups > 1 && !Self::is_vouched_for(&supported, &vouched, members, limit) {
            supported.clear();
        }
        // Runs in rounds, because an island that joined may support the next one.
        while !supported.is_empty() {
            let nearest = Nearest::new(self.pairs, &supported);
            let joining = islands.take_where(|island| {
                let enough = limit * island.len() as f64;
                island.par_iter().any(|&member| {
                    let near = nearest.of(self.pairs.position(member), member, WITNESSES);
                    self.false_alarms(member, &near) <= enough
                })
            });
            if joining.is_empty() {
                break;
            }
            supported.extend(joining);
        }
        supported.sort_unstable();
        let by_chance =
            members.iter().copied().filter(|member| supported.binary_search(member).is_err()).collect();
        let false_alarms =
            members.iter().zip(&vouched).map(|(&member, of)| (member, of.false_alarms)).collect();
        Support { supported, by_chance, false_alarms }
    }

    /// Whether an island has two members, or one that the odometry of its chain supports.
    fn is_vouched_for(island: &[usize], vouched: &[Vouched], members: &[usize], limit: f64) -> bool {
        match island {
            [] => false,
            [only] => members.binary_search(only).is_ok_and(|place| vouched[place].odometry <= limit),
            _ => true,
        }
    }

    fn vouched(&self, member: usize, nearest: &Nearest) -> Vouched {
        let near = nearest.of(self.pairs.position(member), member, WITNESSES);
        let odometry = self.with_odometry(member);
        let evidence: Vec<Option<Evidence>> = near.iter().map(|&other| self.with(member, other)).collect();
        Vouched {
            false_alarms: self.count(best(evidence.iter().copied().chain([odometry]))),
            odometry: self.count(odometry),
            near: near.into_iter().zip(evidence.into_iter().map(|link| self.count(link))).collect(),
        }
    }
}

/// The evidence of the best witness: the one of least |S| / |S + R|, the first among equals.
fn best(evidence: impl Iterator<Item = Option<Evidence>>) -> Option<Evidence> {
    evidence.flatten().min_by(|one, other| one.ratio.total_cmp(&other.ratio))
}

/// The most false alarms that an edge may cause. Of k edges that cause up to a each, a are expected to be wrong; the best k
/// has the greatest gain k - a - cost a. One more edge is also worth its cost if it adds less than 1 / (1 + cost) to the
/// expected number of wrong edges. O(n log n).
pub fn acceptable(mut false_alarms: Vec<f64>, cost: f64) -> f64 {
    let weight = 1.0 + cost;
    false_alarms.sort_by(f64::total_cmp);
    // The gain k - a - cost a = k - (1 + cost) a of the k smallest numbers, where a is the largest of these.
    let mut best = (0.0, 0.0);
    for (place, &expected) in false_alarms.iter().enumerate() {
        let gain = (place + 1) as f64 - weight * expected;
        if gain > best.0 {
            best = (gain, expected);
        }
    }
    best.1 + 1.0 / weight
}

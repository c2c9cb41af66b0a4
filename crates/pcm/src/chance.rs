//! Agreement by chance: how many edges between random places would agree as well.
//!
//! The number of false alarms of an edge (a contrario: Desolneux, Moisan, Morel, IJCV 2000); [`Chance`] gives the
//! formula. `islands` splits the members of a set into those that hang together. Depends on odometry and pairs.

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

/// What a wrong edge weighs, in correct ones, unless told otherwise.
pub const COST: f64 = 3.0;
/// Candidates whose places tell how far apart two of them may be; more would not change the answer.
const SAMPLE: usize = 1000;
/// Members that may vouch for an edge.
const WITNESSES: usize = 16;

/// Counts false alarms among the candidates of a group (a contrario: Desolneux, Moisan, Morel, IJCV 2000).
///
/// Across a long stretch of odometry nearly everything agrees. An edge that joins two places at random is off by the
/// relative pose of two places; its distribution is taken for Gaussian, with the second moment R that pairs of the
/// candidates' places in chain B have. The chance that it agrees with a witness as well as a candidate at distance d does
/// is the volume of the ellipsoid within d times that density at its centre,
///
/// p = d^D / (2^(D/2) Gamma(D/2 + 1)) sqrt(|S| / |S + R|),    at most 1,
///
/// S the covariance of the loop through both, D the degrees of freedom. Of N candidates, N p would agree as well if all
/// were random: their number of false alarms. Its witness is the one of least |S| / |S + R|, which does not look at d, so
/// that the numbers of random edges are evenly spread up to N.
pub struct Chance<'a, G, const DOF: usize> {
    pairs: &'a Pairs<'a, G, DOF>,
    pool: Pool<DOF>,
    /// ln Gamma(D/2 + 1)
    log_gamma: f64,
}

/// What the groups of a graph share: a group of few candidates cannot tell by itself what chance does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pool<const DOF: usize> {
    /// R, as seen at a place of chain B.
    apart: SMatrix<f64, DOF, DOF>,
    /// N, over all groups: false edges fall into any of them.
    candidates: usize,
    groups: usize,
}

impl<const DOF: usize> Pool<DOF> {
    /// O(1) a group: a thousand pairs of places.
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

/// Which agreement is accepted: what a wrong edge costs, and among which candidates chance has its choice.
#[derive(Clone, Copy, Debug)]
pub struct Acceptance<const DOF: usize> {
    /// How many correct edges a wrong one weighs as much as.
    pub cost: f64,
    pool: Option<Pool<DOF>>,
}

impl<const DOF: usize> Acceptance<DOF> {
    /// Among the candidates of a group by itself.
    pub fn within_group(cost: f64) -> Self {
        Self { cost, pool: None }
    }

    /// Among those of all groups of the graph.
    pub(crate) fn within(cost: f64, pool: Option<Pool<DOF>>) -> Self {
        Self { cost, pool }
    }

    /// Counts the false alarms of a group's candidates. O(1): a thousand pairs of places.
    pub(crate) fn chance<'a, G: Spatial<DOF>>(&self, pairs: &'a Pairs<'a, G, DOF>) -> Chance<'a, G, DOF> {
        match self.pool {
            Some(pool) => Chance::among(pairs, pool),
            None => Chance::new(pairs),
        }
    }
}

/// Which members agree not by chance alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Support {
    /// Members that stay, ascending.
    pub supported: Vec<usize>,
    /// Members that agree no better than chance, ascending.
    pub by_chance: Vec<usize>,
    /// Each member with the false alarms that it would cause.
    pub false_alarms: Vec<(usize, f64)>,
}

/// What a loop through an edge and its witness says.
#[derive(Clone, Copy)]
struct Evidence {
    /// |S| / |S + R|
    ratio: f64,
    squared_distance: f64,
}

/// The false alarms that a member would cause: with its best witness, with the odometry, and with each member near it.
struct Vouched {
    false_alarms: f64,
    odometry: f64,
    near: Vec<(usize, f64)>,
}

impl<'a, G: Spatial<DOF>, const DOF: usize> Chance<'a, G, DOF> {
    /// Judges a group by itself. O(1): a thousand pairs of places.
    pub fn new(pairs: &'a Pairs<'a, G, DOF>) -> Self {
        Self::among(pairs, Pool::of_places(std::iter::once((pairs.chain_b, pairs.candidates))))
    }

    fn among(pairs: &'a Pairs<'a, G, DOF>, pool: Pool<DOF>) -> Self {
        Self { pairs, pool, log_gamma: ln_gamma(0.5 * DOF as f64 + 1.0) }
    }

    /// The false alarms that an edge would cause, with the best of these candidates or, within one chain, the odometry
    /// alone for its witness; N without any. O(witnesses).
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
        // R is seen at the candidate's place, and the loop's covariance S in the frame of chain B: the adjoint carries R there.
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
        // d^D / (2^(D/2) Gamma(D/2 + 1)) = exp(D/2 ln(d^2 / 2) - ln Gamma(D/2 + 1)): in logarithms, for d^D overflows at large d.
        let chance = evidence.map_or(1.0, |Evidence { ratio, squared_distance }| {
            (0.5 * DOF as f64 * (0.5 * squared_distance).ln() - self.log_gamma).exp() * ratio.sqrt()
        });
        self.pool.candidates as f64 * chance.min(1.0)
    }

    /// Divides members, which ascend, into those that agree not by chance and the others, where a wrong edge weighs as much
    /// as `cost` correct ones.
    ///
    /// Members vouch for each other where a link causes no more false alarms than [`acceptable`] says. Within one chain the
    /// odometry is where it begins; between two, the largest island of members that hang together. One more island of m
    /// members joins if its best link causes at most m times as many: of N candidates there are at most N / m such islands.
    /// In a graph with one group something to begin with always stays, be it a lone candidate. With several groups a lone
    /// member that nobody vouches for goes: each group would keep one otherwise, and false edges spread over many groups.
    /// O(n log n), and as much again for each round in which islands join.
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
        // Islands before counts: two overlaps far apart cannot vouch for each other across the odometry between, and judged one by
        // one, all members of the smaller would look like chance.
        let mut islands = Islands::of(members, &links);
        let mut supported = islands.take_first();
        if self.pool.groups > 1 && !Self::is_vouched_for(&supported, &vouched, members, limit) {
            supported.clear();
        }
        // In rounds, since an island that joined may vouch for the next one.
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

    /// Whether an island has two members, or one that the odometry of its chain vouches for.
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

/// The evidence of the witness that says most: of least |S| / |S + R|, the first among equals.
fn best(evidence: impl Iterator<Item = Option<Evidence>>) -> Option<Evidence> {
    evidence.flatten().min_by(|one, other| one.ratio.total_cmp(&other.ratio))
}

/// The most false alarms that an edge may cause: of k edges that cause up to a each, a are expected to be wrong, and the k
/// of which k - a - cost a is greatest are worth it. One more edge then is, too, if it adds less than 1 / (1 + cost) to what
/// is expected. O(n log n).
pub fn acceptable(mut false_alarms: Vec<f64>, cost: f64) -> f64 {
    let weight = 1.0 + cost;
    false_alarms.sort_by(f64::total_cmp);
    // The gain k - a - cost a, that is k - (1 + cost) a, at the k smallest; a is the largest of them.
    let mut best = (0.0, 0.0);
    for (place, &expected) in false_alarms.iter().enumerate() {
        let gain = (place + 1) as f64 - weight * expected;
        if gain > best.0 {
            best = (gain, expected);
        }
    }
    best.1 + 1.0 / weight
}

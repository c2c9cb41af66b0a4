//! Whether two candidates agree, and the graph of those that do.

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use rayon::prelude::*;

use crate::Gate;
use crate::candidate::{Candidate, Group};
use crate::chain::{Chain, Chains, squared_mahalanobis};
use crate::clique::BitGraph;

/// The loop through candidates a = (i, k, `Z_a`) and b = (j, l, `Z_b`) and the odometry between them,
///
/// E = `Z_a`^-1 (P_i^-1 P_j) `Z_b` (Q_l^-1 Q_k)            (Mangelson et al., equation 6)
///
/// with its covariance, told by the squared Mahalanobis distance of Log(E) from zero. The distance does not
/// change when the loop is conjugated by Q_k, which gives Q_k E Q_k^-1 = T_a^-1 T_b for the alignments T and
///
/// Sigma = C_a + C_b + Ad(T_a^-1) dS_A Ad(T_a^-1)^T + dS_B,
///
/// one change of frame a pair. Within one chain the two stretches of odometry may share steps: those enter
/// once, through the sum of both their effects, each with its sign.
///
/// `None` if Sigma is not positive definite. O(1).
pub fn squared_distance<G: LieGroup<DOF>, const DOF: usize>(
    chain_a: &Chain<G, DOF>,
    chain_b: &Chain<G, DOF>,
    same_chain: bool,
    a: &Candidate<G, DOF>,
    b: &Candidate<G, DOF>,
) -> Option<f64> {
    let error = a.alignment.between(&b.alignment).log();
    let mut covariance = a.covariance + b.covariance;
    let mut stretch_a = chain_a.covariance_between(a.i, b.i);
    let mut stretch_b = chain_b.covariance_between(b.k, a.k);
    if same_chain && let Some(shared) = Shared::of(a, b) {
        let both = shared.effect(&a.to_b);
        let steps = chain_a.covariance_between(shared.first, shared.last);
        covariance += both * steps * both.transpose();
        stretch_a -= steps;
        stretch_b -= steps;
    }
    covariance += a.to_b * stretch_a * a.to_b.transpose() + stretch_b;
    squared_mahalanobis(&covariance, &error)
}

/// Steps that belong to both stretches of odometry, i to j and l to k.
struct Shared {
    first: usize,
    last: usize,
    same_direction: bool,
}

impl Shared {
    fn of<G, const DOF: usize>(a: &Candidate<G, DOF>, b: &Candidate<G, DOF>) -> Option<Self> {
        let first = a.i.min(b.i).max(a.k.min(b.k));
        let last = a.i.max(b.i).min(a.k.max(b.k));
        // The first stretch runs from i to j, the second from l back to k.
        (first < last).then_some(Self { first, last, same_direction: (a.i < b.i) == (b.k < a.k) })
    }

    /// The error of a shared step acts through the stretch of A and through that of B at once.
    fn effect<const DOF: usize>(&self, to_b: &SMatrix<f64, DOF, DOF>) -> SMatrix<f64, DOF, DOF> {
        if self.same_direction { to_b + SMatrix::identity() } else { to_b - SMatrix::identity() }
    }
}

/// The consistency graph of a group of candidates.
#[derive(Clone, Debug)]
pub struct Consistency {
    /// One vertex a candidate, an edge between those that are consistent.
    pub graph: BitGraph,
    /// Pairs whose covariance is not positive definite: never consistent.
    pub indefinite: usize,
}

/// Tests all pairs of a group: N (N - 1) / 2 distances, rows in parallel, the same result at any number of
/// threads.
pub fn consistency_graph<G: LieGroup<DOF>, const DOF: usize>(
    chains: &Chains<G, DOF>,
    group: &Group<G, DOF>,
    gate: Gate,
) -> Consistency {
    let (chain_a, chain_b) = (&chains.chains[group.a], &chains.chains[group.b]);
    let candidates = &group.candidates;
    let rows: Vec<(Vec<usize>, usize)> = (0..candidates.len())
        .into_par_iter()
        .map(|row| {
            let (mut consistent, mut indefinite) = (Vec::new(), 0);
            for column in row + 1..candidates.len() {
                let same_chain = group.a == group.b;
                match squared_distance(chain_a, chain_b, same_chain, &candidates[row], &candidates[column]) {
                    Some(distance) if distance <= gate.squared_distance => consistent.push(column),
                    Some(_) => {}
                    None => indefinite += 1,
                }
            }
            (consistent, indefinite)
        })
        .collect();
    let mut graph = BitGraph::new(candidates.len());
    let mut indefinite = 0;
    for (row, (columns, count)) in rows.into_iter().enumerate() {
        indefinite += count;
        for column in columns {
            graph.connect(row, column);
        }
    }
    Consistency { graph, indefinite }
}

//! Landmark edges as candidates, grouped by the two chains they join.

use std::collections::BTreeMap;

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use posecut_graph::{EdgeKind, PoseGraph};

use crate::PcmError;
use crate::odometry::chain::{Chain, Chains, Covariances, covariance};

/// A landmark edge between index `i` of chain A and index `k` of chain B.
#[derive(Clone, Debug)]
pub struct Candidate<G, const DOF: usize> {
    /// Its index among the graph's edges.
    pub edge: usize,
    /// The index in chain A.
    pub i: usize,
    /// The index in chain B.
    pub k: usize,
    /// The alignment of B to A that it measures: T = P_i Z Q_k^-1.
    pub alignment: G,
    /// Its inverse, the alignment of A to B.
    pub from_a: G,
    /// The adjoint of its inverse, which carries covariances of chain A to the frame of B.
    pub to_b: SMatrix<f64, DOF, DOF>,
    /// The measurement's covariance in the frame of chain B: Ad(Q_k) Sigma_Z Ad(Q_k)^T.
    pub covariance: SMatrix<f64, DOF, DOF>,
}

impl<G: LieGroup<DOF>, const DOF: usize> Candidate<G, DOF> {
    /// A candidate from a node of chain A to a node of chain B, with the measured pose of the second node in the frame of
    /// the first. `edge` is its index among the caller's edges.
    pub fn new(
        edge: usize,
        (chain_a, i): (&Chain<G, DOF>, usize),
        (chain_b, k): (&Chain<G, DOF>, usize),
        measurement: &G,
        covariance: &SMatrix<f64, DOF, DOF>,
    ) -> Self {
        let alignment = chain_a.poses[i].compose(measurement).compose(&chain_b.poses[k].inverse());
        let adjoint = chain_b.poses[k].adjoint();
        let from_a = alignment.inverse();
        Self {
            edge,
            i,
            k,
            alignment,
            from_a,
            to_b: from_a.adjoint(),
            covariance: adjoint * covariance * adjoint.transpose(),
        }
    }
}

/// Reverses a measurement: Z^-1 with Ad(Z) Sigma Ad(Z)^T.
fn turned_round<G: LieGroup<DOF>, const DOF: usize>(
    measurement: &G,
    covariance: &SMatrix<f64, DOF, DOF>,
) -> (G, SMatrix<f64, DOF, DOF>) {
    let adjoint = measurement.adjoint();
    (measurement.inverse(), adjoint * covariance * adjoint.transpose())
}

/// The candidates between two chains; both may be the same one.
#[derive(Clone, Debug)]
pub struct Group<G, const DOF: usize> {
    /// Chain A.
    pub a: usize,
    /// Chain B, not before A.
    pub b: usize,
    /// The candidates in the order of the graph's edges.
    pub candidates: Vec<Candidate<G, DOF>>,
}

/// The landmark edges of a graph, in groups.
#[derive(Clone, Debug)]
pub struct Grouped<G, const DOF: usize> {
    /// Groups in ascending order of their chains.
    pub groups: Vec<Group<G, DOF>>,
    /// Landmark edges without a measurement, which cannot be tested.
    pub unmeasured: usize,
    /// Landmark edges that an earlier stage has rejected.
    pub rejected_before: usize,
}

/// Groups the landmark edges in use. An edge stored from B to A is reversed: Z^-1, Ad(Z) Sigma Ad(Z)^T.
pub fn group<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    chains: &Chains<G, DOF>,
) -> Result<Grouped<G, DOF>, PcmError> {
    group_with(graph, chains, Covariances::Needed)
}

/// As [`group`], with or without covariances.
pub fn group_with<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    chains: &Chains<G, DOF>,
    covariances: Covariances,
) -> Result<Grouped<G, DOF>, PcmError> {
    let mut groups: BTreeMap<(usize, usize), Vec<Candidate<G, DOF>>> = BTreeMap::new();
    let (mut unmeasured, mut rejected_before) = (0, 0);
    for (index, edge) in graph.edges.iter().enumerate() {
        if edge.kind != EdgeKind::Landmark {
            continue;
        }
        if !edge.in_use() {
            rejected_before += 1;
            continue;
        }
        let Some(measurement) = edge.measurement.as_deref().and_then(G::from_components) else {
            unmeasured += 1;
            continue;
        };
        let Some((from, to)) = graph.ends(edge) else { continue };
        let (from, to) = (chains.places[from], chains.places[to]);
        let covariance = covariance::<DOF>(graph, edge, covariances)?;
        let forward = from <= to;
        let (measurement, covariance) =
            if forward { (measurement, covariance) } else { turned_round(&measurement, &covariance) };
        let (from, to) = if forward { (from, to) } else { (to, from) };
        let (chain_a, chain_b) = (&chains.chains[from.0], &chains.chains[to.0]);
        let candidate = Candidate::new(index, (chain_a, from.1), (chain_b, to.1), &measurement, &covariance);
        groups.entry((from.0, to.0)).or_default().push(candidate);
    }
    let groups = groups.into_iter().map(|((a, b), candidates)| Group { a, b, candidates }).collect();
    Ok(Grouped { groups, unmeasured, rejected_before })
}

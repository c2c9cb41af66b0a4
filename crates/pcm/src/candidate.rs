//! Landmark edges as candidates, grouped by the two chains they join.

use std::collections::BTreeMap;

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use posecut_graph::{EdgeKind, PoseGraph};

use crate::PcmError;
use crate::chain::{Chains, covariance};

/// A landmark edge between place `i` of chain A and place `k` of chain B.
#[derive(Clone, Debug)]
pub struct Candidate<G, const DOF: usize> {
    /// Its place among the graph's edges.
    pub edge: usize,
    /// The place in chain A.
    pub i: usize,
    /// The place in chain B.
    pub k: usize,
    /// The alignment of B to A that it claims: T = P_i Z Q_k^-1.
    pub alignment: G,
    /// The adjoint of its inverse, which carries covariances of chain A to the frame of B.
    pub to_b: SMatrix<f64, DOF, DOF>,
    /// The measurement's covariance in the frame of chain B: Ad(Q_k) Sigma_Z Ad(Q_k)^T.
    pub covariance: SMatrix<f64, DOF, DOF>,
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

/// What became of the graph's landmark edges.
#[derive(Clone, Debug)]
pub struct Grouped<G, const DOF: usize> {
    /// Groups in ascending order of their chains.
    pub groups: Vec<Group<G, DOF>>,
    /// Landmark edges without a measurement: nothing to test.
    pub unmeasured: usize,
    /// Landmark edges that an earlier stage has rejected.
    pub rejected_before: usize,
}

/// Groups the landmark edges in use. An edge stored from B to A is turned round: Z^-1, Ad(Z) Sigma Ad(Z)^T.
pub fn group<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    chains: &Chains<G, DOF>,
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
        let (Some(from), Some(to)) = (graph.node_index(edge.from), graph.node_index(edge.to)) else {
            continue;
        };
        let (mut from, mut to) = (chains.places[from], chains.places[to]);
        let (mut measurement, mut covariance) = (measurement, covariance::<DOF>(graph, edge)?);
        if from > to {
            std::mem::swap(&mut from, &mut to);
            let adjoint = measurement.adjoint();
            covariance = adjoint * covariance * adjoint.transpose();
            measurement = measurement.inverse();
        }
        let (pose_i, pose_k) = (&chains.chains[from.0].poses[from.1], &chains.chains[to.0].poses[to.1]);
        let alignment = pose_i.compose(&measurement).compose(&pose_k.inverse());
        let adjoint = pose_k.adjoint();
        groups.entry((from.0, to.0)).or_default().push(Candidate {
            edge: index,
            i: from.1,
            k: to.1,
            alignment,
            to_b: alignment.inverse().adjoint(),
            covariance: adjoint * covariance * adjoint.transpose(),
        });
    }
    let groups = groups.into_iter().map(|((a, b), candidates)| Group { a, b, candidates }).collect();
    Ok(Grouped { groups, unmeasured, rejected_before })
}

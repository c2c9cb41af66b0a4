//! Odometry chains: accumulated poses and covariances.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use nalgebra::{SMatrix, SVector};
use petgraph::unionfind::UnionFind;
use posecut_geometry::LieGroup;
use posecut_geometry::covariance::{CovarianceError, covariance_from_information};
use posecut_graph::{Edge, EdgeKind, PoseGraph};

use crate::PcmError;

/// The information added to each direction of a repaired matrix, as a share of its diagonal.
const SINGULAR_SHARE: f64 = 1e-9;

/// Nodes in a row, each joined to the next by odometry.
///
/// `poses[n]` is P_n in the frame of the chain's first node. `covariances[n]` is the sum of the step covariances up to n,
/// each carried to that frame: S_(n+1) = S_n + Ad(P_(n+1)) Q_n Ad(P_(n+1))^T. In that frame, the covariance of the stretch
/// from i to j is then S_j - S_i, exact to first order for independent steps.
#[derive(Clone, Debug)]
pub struct Chain<G, const DOF: usize> {
    /// Accumulated poses.
    pub poses: Vec<G>,
    /// Accumulated covariances.
    pub covariances: Vec<SMatrix<f64, DOF, DOF>>,
    /// Distance travelled up to each node, metres.
    pub travelled: Vec<f64>,
}

impl<G: LieGroup<DOF>, const DOF: usize> Default for Chain<G, DOF> {
    /// A chain of one node.
    fn default() -> Self {
        Self { poses: vec![G::identity()], covariances: vec![SMatrix::zeros()], travelled: vec![0.0] }
    }
}

impl<G: LieGroup<DOF>, const DOF: usize> Chain<G, DOF> {
    /// The covariance between two nodes of the chain, in the chain's frame. O(1).
    #[inline(always)]
    pub fn covariance_between(&self, one: usize, other: usize) -> SMatrix<f64, DOF, DOF> {
        let (early, late) = (one.min(other), one.max(other));
        self.covariances[late] - self.covariances[early]
    }

    /// Adds a node, given the motion to it from the last node and the covariance of this motion.
    pub fn push(&mut self, motion: &G, covariance: &SMatrix<f64, DOF, DOF>) {
        let last = self.poses.len() - 1;
        let pose = self.poses[last].compose(motion);
        let adjoint = pose.adjoint();
        self.covariances.push(self.covariances[last] + adjoint * covariance * adjoint.transpose());
        let [x, y, z] = motion.translation();
        self.travelled.push(self.travelled[last] + x.hypot(y).hypot(z));
        self.poses.push(pose);
    }
}

/// All chains of a graph, and the position of each node in them.
#[derive(Clone, Debug)]
pub struct Chains<G, const DOF: usize> {
    /// The chains, by their node of lowest id.
    pub chains: Vec<Chain<G, DOF>>,
    /// For each node of the graph: its chain and its index there.
    pub places: Vec<(usize, usize)>,
    /// The number of odometry edges that branch off or close a ring, and are in no chain.
    pub left_out: usize,
}

/// Whether covariances are needed: some tests use the measurements alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Covariances {
    /// Every information matrix must have an inverse.
    Needed,
    /// As `Needed`, but a direction without information gets a variance of 10^9 times the others', in units of the
    /// matrix's own diagonal.
    Repaired,
    /// They are not read; all are zero.
    Ignored,
}

impl<G: LieGroup<DOF>, const DOF: usize> Chains<G, DOF> {
    /// Follows the odometry edges of a graph. Every node gets a position; a node without odometry is a chain of one. If
    /// odometry branches or closes a ring, the edges of higher id are left out ([`Self::warning`]). O(edges).
    pub fn of(graph: &PoseGraph) -> Result<Self, PcmError> {
        Self::with(graph, Covariances::Needed)
    }

    /// A warning if some odometry edges are in no chain.
    pub fn warning(&self) -> Option<String> {
        match self.left_out {
            0 => None,
            1 => Some("1 odometry edge branches off or closes a ring; the chains ignore it".to_owned()),
            count => {
                Some(format!("{count} odometry edges branch off or close a ring; the chains ignore them"))
            }
        }
    }

    /// As [`Self::of`], with or without covariances.
    pub fn with(graph: &PoseGraph, covariances: Covariances) -> Result<Self, PcmError> {
        let links = Links::of(graph);
        let mut places = vec![(usize::MAX, 0); graph.nodes.len()];
        let mut chains = Vec::new();
        for Path { nodes, edges } in links.paths() {
            let mut chain = Chain::default();
            for (edge, &node) in edges.into_iter().zip(&nodes) {
                let (motion, covariance) = step(graph, edge, graph.nodes[node].id == edge.from, covariances)?;
                chain.push(&motion, &covariance);
            }
            for (place, node) in nodes.into_iter().enumerate() {
                places[node] = (chains.len(), place);
            }
            chains.push(chain);
        }
        Ok(Self { chains, places, left_out: links.left_out })
    }
}

/// The nodes of each chain of [`Chains`] from end to end, by their indices in the graph. O(edges).
pub fn paths(graph: &PoseGraph) -> Vec<Vec<usize>> {
    Links::of(graph).paths().into_iter().map(|path| path.nodes).collect()
}

/// The motion along an odometry edge with its covariance, in the direction in which the chain passes it.
fn step<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    edge: &Edge,
    forward: bool,
    covariances: Covariances,
) -> Result<(G, SMatrix<f64, DOF, DOF>), PcmError> {
    let motion = edge.measurement.as_deref().and_then(G::from_components).unwrap_or_else(G::identity);
    let covariance = covariance::<DOF>(graph, edge, covariances)?;
    if forward {
        return Ok((motion, covariance));
    }
    let adjoint = motion.adjoint();
    Ok((motion.inverse(), adjoint * covariance * adjoint.transpose()))
}

/// The covariance of an edge's measurement: the inverse of its information.
pub fn covariance<const DOF: usize>(
    graph: &PoseGraph,
    edge: &Edge,
    covariances: Covariances,
) -> Result<SMatrix<f64, DOF, DOF>, PcmError> {
    if covariances == Covariances::Ignored {
        return Ok(SMatrix::zeros());
    }
    let refused = |reason: String| PcmError::Covariance { edge: edge.name(), reason };
    let information = graph
        .information_matrix::<DOF>(edge)
        .ok_or_else(|| refused("the edge has no information matrix".to_owned()))?
        .map_err(|error| refused(error.to_string()))?;
    match covariance_from_information(&information) {
        Err(CovarianceError::Singular { .. }) if covariances == Covariances::Repaired => {
            covariance_from_information(&repaired(information)).map_err(|error| refused(error.to_string()))
        }
        outcome => outcome.map_err(|error| refused(error.to_string())),
    }
}

/// Adds 10^-9 of itself to each diagonal entry; to a zero entry, that share of the largest one.
fn repaired<const DOF: usize>(mut information: SMatrix<f64, DOF, DOF>) -> SMatrix<f64, DOF, DOF> {
    let largest = information.diagonal().max().max(1.0);
    for axis in 0..DOF {
        let entry = information[(axis, axis)];
        information[(axis, axis)] += SINGULAR_SHARE * if entry > 0.0 { entry } else { largest };
    }
    information
}

/// log(E)^T Sigma^-1 log(E) by elimination of the lower triangle, L D L^T; `None` if Sigma is not positive definite. Needs
/// one division a column. Cholesky's square roots and one division an entry would take as long as all other steps.
#[inline(always)]
pub fn squared_mahalanobis<const DOF: usize>(
    covariance: &SMatrix<f64, DOF, DOF>,
    error: &SVector<f64, DOF>,
) -> Option<f64> {
    let mut remaining = covariance.data.0;
    let mut whitened = error.data.0[0];
    let mut sum = 0.0;
    for column in 0..DOF {
        let pivot = remaining[column][column];
        if !(pivot > 0.0) {
            return None;
        }
        let inverse = 1.0 / pivot;
        sum += whitened[column] * whitened[column] * inverse;
        let eliminated = remaining[column];
        for later in column + 1..DOF {
            let ratio = eliminated[later] * inverse;
            whitened[later] -= ratio * whitened[column];
            for (value, term) in remaining[later][later..].iter_mut().zip(&eliminated[later..]) {
                *value -= ratio * term;
            }
        }
    }
    sum.is_finite().then_some(sum)
}

/// Nodes in a row, and the edges between them.
struct Path<'a> {
    nodes: Vec<usize>,
    edges: Vec<&'a Edge>,
}

/// At most two odometry edges a node, and no rings: the graph as paths.
struct Links<'a> {
    links: Vec<[Option<(&'a Edge, usize)>; 2]>,
    /// Odometry edges that branch off or close a ring.
    left_out: usize,
}

impl<'a> Links<'a> {
    fn of(graph: &'a PoseGraph) -> Self {
        let mut links: Vec<[Option<(&Edge, usize)>; 2]> = vec![[None; 2]; graph.nodes.len()];
        let mut parts = UnionFind::<usize>::new(graph.nodes.len());
        let mut left_out = 0_usize;
        for edge in graph.edges_of(EdgeKind::Odometry).filter(|edge| edge.in_use()) {
            let Some((from, to)) = graph.ends(edge) else { continue };
            let full = links[from][1].is_some() || links[to][1].is_some();
            if full || !parts.union(from, to) {
                left_out += 1;
                continue;
            }
            for (here, there) in [(from, to), (to, from)] {
                let free = usize::from(links[here][0].is_some());
                links[here][free] = Some((edge, there));
            }
        }
        Self { links, left_out }
    }

    fn degree(&self, node: usize) -> usize {
        self.links[node].iter().flatten().count()
    }

    /// Every node in one path, each from its end of lowest id.
    fn paths(&self) -> Vec<Path<'a>> {
        let mut seen = vec![false; self.links.len()];
        let mut paths = Vec::new();
        for start in 0..self.links.len() {
            if seen[start] || self.degree(start) > 1 {
                continue;
            }
            seen[start] = true;
            let mut path = Path { nodes: vec![start], edges: Vec::new() };
            let mut here = start;
            while let Some((edge, next)) = self.next(here, |node| seen[node]) {
                seen[next] = true;
                path.nodes.push(next);
                path.edges.push(edge);
                here = next;
            }
            paths.push(path);
        }
        paths
    }

    fn next(&self, node: usize, seen: impl Fn(usize) -> bool) -> Option<(&'a Edge, usize)> {
        self.links[node].iter().flatten().find(|(_, there)| !seen(*there)).copied()
    }
}

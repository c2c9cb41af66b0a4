//! The graph to optimise, checked.

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use posecut_geometry::covariance::{Definiteness, definiteness};
use thiserror::Error;

use super::kernel::Kernel;
use super::prior::{Prior, PriorError};

/// The origin of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeKind {
    /// Dead reckoning between consecutive nodes.
    Odometry,
    /// A landmark edge (loop closure).
    Landmark,
}

/// A measured relative pose.
#[derive(Clone, Copy, Debug)]
pub struct Edge<G, const DOF: usize> {
    /// Node that the measurement starts from.
    pub from: usize,
    /// Node at which the measurement ends.
    pub to: usize,
    /// Pose of `to` in the frame of `from`.
    pub measurement: G,
    /// Inverse covariance of the right perturbation of `measurement`.
    pub information: SMatrix<f64, DOF, DOF>,
    /// Odometry or landmark.
    pub kind: EdgeKind,
    /// Robust kernel, if the edge may be an outlier.
    pub kernel: Option<Kernel>,
}

impl<G, const DOF: usize> Edge<G, DOF> {
    /// An edge without robust kernel.
    pub fn new(
        from: usize,
        to: usize,
        measurement: G,
        information: SMatrix<f64, DOF, DOF>,
        kind: EdgeKind,
    ) -> Self {
        Self { from, to, measurement, information, kind, kernel: None }
    }
}

/// Why a graph cannot be optimised.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ProblemError {
    /// An edge names a node that does not exist.
    #[error(
        "edge {edge} names node {node}, but there are {nodes} nodes, numbered from 0: add the node or remove the edge"
    )]
    MissingNode {
        /// Index of the edge.
        edge: usize,
        /// The node.
        node: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// An edge joins a node to itself.
    #[error("edge {edge} joins node {node} to itself and constrains nothing: remove it")]
    SelfLoop {
        /// Index of the edge.
        edge: usize,
        /// Node at both ends.
        node: usize,
    },
    /// A pose is not finite.
    #[error(
        "the pose of node {node} is not finite: give it finite components or start from another initialisation"
    )]
    PoseNotFinite {
        /// Index of the node.
        node: usize,
    },
    /// A measurement or information matrix is not finite.
    #[error("edge {edge} ({from} -> {to}) holds a number that is not finite: remove or correct it")]
    EdgeNotFinite {
        /// Index of the edge.
        edge: usize,
        /// Its first node.
        from: usize,
        /// Its second node.
        to: usize,
    },
    /// An information matrix is not symmetric.
    #[error(
        "the information matrix of edge {edge} ({from} -> {to}) is not symmetric: give the mean of the two halves"
    )]
    NotSymmetric {
        /// Index of the edge.
        edge: usize,
        /// Its first node.
        from: usize,
        /// Its second node.
        to: usize,
    },
    /// An information matrix has a negative eigenvalue.
    #[error(
        "the information matrix of edge {edge} ({from} -> {to}) is indefinite (eigenvalues from {smallest:e} to \
         {largest:e}): no covariance has this inverse; correct it or raise its negative eigenvalues to zero"
    )]
    Indefinite {
        /// Index of the edge.
        edge: usize,
        /// Its first node.
        from: usize,
        /// Its second node.
        to: usize,
        /// Smallest eigenvalue.
        smallest: f64,
        /// Largest eigenvalue.
        largest: f64,
    },
    /// A node that should be held does not exist.
    #[error(
        "node {node} is to be held, but there are {nodes} nodes, numbered from 0: add it or do not hold it"
    )]
    MissingHeld {
        /// The node.
        node: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// A prior cannot be used.
    #[error(transparent)]
    Prior(#[from] PriorError),
    /// A kernel's parameter is not a positive number.
    #[error("the robust kernel of edge {edge} has the parameter {parameter}: it must be positive and finite")]
    KernelParameter {
        /// Index of the edge.
        edge: usize,
        /// The parameter.
        parameter: f64,
    },
}

/// Poses and edges whose numbers are finite, whose indices exist, and whose information matrices are semidefinite.
#[derive(Clone, Debug)]
pub struct Problem<G, const DOF: usize> {
    poses: Vec<G>,
    edges: Vec<Edge<G, DOF>>,
    held: Vec<bool>,
    priors: Vec<Prior<G, DOF>>,
    semidefinite: Vec<usize>,
}

impl<G: LieGroup<DOF>, const DOF: usize> Problem<G, DOF> {
    /// Checks a graph. `poses` are the given initial poses. The first node of each connected component keeps its pose, unless
    /// the component has held nodes ([`hold`](Self::hold)) or priors ([`with_priors`](Self::with_priors)).
    ///
    /// Matrices that are semidefinite up to the digits of a printed file (smallest eigenvalue within 1e-9 times the largest)
    /// are accepted unchanged and listed. Takes O(nodes + edges).
    pub fn new(poses: Vec<G>, edges: Vec<Edge<G, DOF>>) -> Result<Self, ProblemError> {
        if let Some(node) = poses.iter().position(|pose| !is_finite(pose)) {
            return Err(ProblemError::PoseNotFinite { node });
        }
        let mut semidefinite = Vec::new();
        for (index, edge) in edges.iter().enumerate() {
            if check_edge(index, edge, poses.len())? {
                semidefinite.push(index);
            }
        }
        let held = vec![false; poses.len()];
        Ok(Self { poses, edges, held, priors: Vec::new(), semidefinite })
    }

    /// Holds these nodes at their given poses, as constants: g2o's `FIX`. One held node only moves the minima of its
    /// component rigidly; several constrain the component.
    pub fn hold(mut self, nodes: impl IntoIterator<Item = usize>) -> Result<Self, ProblemError> {
        for node in nodes {
            let count = self.held.len();
            *self.held.get_mut(node).ok_or(ProblemError::MissingHeld { node, nodes: count })? = true;
        }
        Ok(self)
    }

    /// Adds measurements of single nodes. In a component with priors no node is held except those of [`hold`](Self::hold): one
    /// pose fixes the component, and so do the positions of two nodes in the plane, or of three in space that are not on a line.
    pub fn with_priors(mut self, priors: Vec<Prior<G, DOF>>) -> Result<Self, ProblemError> {
        for (index, prior) in priors.iter().enumerate() {
            prior.check(index, self.poses.len())?;
        }
        self.priors = priors;
        Ok(self)
    }

    /// The same without checks.
    pub(crate) fn with_checked_priors(self, priors: Vec<Prior<G, DOF>>) -> Self {
        Self { priors, ..self }
    }

    /// The measurements of single nodes.
    pub fn priors(&self) -> &[Prior<G, DOF>] {
        &self.priors
    }

    /// Whether each node is held at its given pose.
    pub fn held(&self) -> &[bool] {
        &self.held
    }

    /// The given poses.
    pub fn poses(&self) -> &[G] {
        &self.poses
    }

    /// The edges.
    pub fn edges(&self) -> &[Edge<G, DOF>] {
        &self.edges
    }

    /// Edges whose information matrices are only semidefinite, up to the digits of a printed file.
    pub fn semidefinite(&self) -> &[usize] {
        &self.semidefinite
    }

    /// A graph made of edges and poses that were checked before.
    pub fn from_checked(poses: Vec<G>, edges: Vec<Edge<G, DOF>>, held: Vec<bool>) -> Self {
        Self { poses, edges, held, priors: Vec::new(), semidefinite: Vec::new() }
    }
}

/// Whether all components of a pose are finite.
pub fn is_finite<G: LieGroup<DOF>, const DOF: usize>(pose: &G) -> bool {
    pose.components().iter().all(|component| component.is_finite())
}

/// Returns whether the information matrix is only semidefinite; the error is what is wrong with the edge.
pub fn check_edge<G: LieGroup<DOF>, const DOF: usize>(
    index: usize,
    edge: &Edge<G, DOF>,
    nodes: usize,
) -> Result<bool, ProblemError> {
    let &Edge { from, to, .. } = edge;
    if let Some(node) = [from, to].into_iter().find(|&node| node >= nodes) {
        return Err(ProblemError::MissingNode { edge: index, node, nodes });
    }
    if from == to {
        return Err(ProblemError::SelfLoop { edge: index, node: from });
    }
    if !is_finite(&edge.measurement) {
        return Err(ProblemError::EdgeNotFinite { edge: index, from, to });
    }
    if let Some(parameter) = edge.kernel.map(Kernel::parameter).filter(|&p| !(p > 0.0 && p.is_finite())) {
        return Err(ProblemError::KernelParameter { edge: index, parameter });
    }
    let information = &edge.information;
    let asymmetry = (information - information.transpose()).amax();
    if asymmetry > 1e-9 * information.amax() {
        return Err(ProblemError::NotSymmetric { edge: index, from, to });
    }
    if is_clearly_positive(information) {
        return Ok(false);
    }
    match definiteness(information) {
        Definiteness::PositiveDefinite => Ok(false),
        Definiteness::Semidefinite { .. } => Ok(true),
        Definiteness::NotFinite => Err(ProblemError::EdgeNotFinite { edge: index, from, to }),
        Definiteness::Indefinite { smallest, largest } => {
            Err(ProblemError::Indefinite { edge: index, from, to, smallest, largest })
        }
    }
}

/// Whether elimination leaves a fair share of every diagonal entry, and of the largest one. This test is a hundred times
/// cheaper than eigenvalues, and nearly every edge passes it.
fn is_clearly_positive<const DOF: usize>(matrix: &SMatrix<f64, DOF, DOF>) -> bool {
    let mut rest = *matrix;
    let least = 1e-8 * matrix.diagonal().max();
    for index in 0..DOF {
        let pivot = rest[(index, index)];
        if !(pivot > least.max(1e-6 * matrix[(index, index)]) && pivot.is_finite()) {
            return false;
        }
        for row in index + 1..DOF {
            let factor = rest[(row, index)] / pivot;
            for column in index + 1..DOF {
                rest[(row, column)] -= factor * rest[(index, column)];
            }
        }
    }
    true
}

//! Measurements of single nodes: of a pose, or of a position alone.
//!
//! With the pose `X = (R, t)` of the node, the residual of a measured pose `Z` is `e = Log(Z^-1 X)`, and that of a measured
//! position `z` is `e = t - z`, with no rotation components. In a right perturbation `X Exp(d)` their Jacobians are `J_r^-1(e)`
//! and `[R, 0]`: `t` moves by `R d_t` to first order.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::covariance::{Definiteness, definiteness};
use posecut_geometry::{LieGroup, translations};
use posecut_graph::PriorOf;
use posecut_graph::connectivity::Component;
use thiserror::Error;

use super::kernel::{Kernel, charge};
use super::problem::is_finite;

/// A measurement of one node in the frame of the map.
#[derive(Clone, Copy, Debug)]
pub struct Prior<G, const DOF: usize> {
    /// The node.
    pub node: usize,
    /// The measured pose; only its translation counts if it measures a position.
    pub measurement: G,
    /// Inverse covariance: of the right perturbation of a measured pose; of a position along the axes of the map, with zeros for
    /// the rotation.
    pub information: SMatrix<f64, DOF, DOF>,
    /// What it measures.
    pub of: PriorOf,
    /// Robust kernel, if the prior may be an outlier.
    pub kernel: Option<Kernel>,
}

/// Why a prior cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PriorError {
    /// It names a node that does not exist.
    #[error(
        "prior {prior} names node {node}, but there are {nodes} nodes, numbered from 0: add the node or remove the prior"
    )]
    MissingNode {
        /// Index of the prior.
        prior: usize,
        /// The node.
        node: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// A measurement or information matrix is not finite.
    #[error("prior {prior} of node {node} holds a number that is not finite: remove or correct it")]
    NotFinite {
        /// Index of the prior.
        prior: usize,
        /// Its node.
        node: usize,
    },
    /// An information matrix is not symmetric, or has a negative eigenvalue.
    #[error(
        "the information matrix of prior {prior} of node {node} is not symmetric and positive semidefinite: give the inverse of a \
         covariance"
    )]
    NotSemidefinite {
        /// Index of the prior.
        prior: usize,
        /// Its node.
        node: usize,
    },
    /// The prior of a position has information about the rotation.
    #[error(
        "prior {prior} of node {node} measures a position, but its information weighs a rotation: set those terms to zero"
    )]
    RotationOfPosition {
        /// Index of the prior.
        prior: usize,
        /// Its node.
        node: usize,
    },
    /// A kernel's parameter is not a positive number.
    #[error(
        "the robust kernel of prior {prior} has the parameter {parameter}: it must be positive and finite"
    )]
    KernelParameter {
        /// Index of the prior.
        prior: usize,
        /// The parameter.
        parameter: f64,
    },
}

/// Quadratic model of a prior's cost around the current pose, in its right perturbation.
pub(crate) struct LinearisedPrior<const DOF: usize> {
    /// Block of the normal equations at the node.
    pub(crate) block: SMatrix<f64, DOF, DOF>,
    /// Half the gradient.
    pub(crate) gradient: SVector<f64, DOF>,
    /// `rho(e^T Omega e)`.
    pub(crate) cost: f64,
}

impl<G: LieGroup<DOF>, const DOF: usize> Prior<G, DOF> {
    /// A prior of a pose, without robust kernel.
    pub fn pose(node: usize, measurement: G, information: SMatrix<f64, DOF, DOF>) -> Self {
        Self { node, measurement, information, of: PriorOf::Pose, kernel: None }
    }

    /// A prior of a position, without robust kernel. `at` is a pose at that position, with any rotation; `information` has zeros
    /// in the rows and columns of the rotation.
    pub fn position(node: usize, at: G, information: SMatrix<f64, DOF, DOF>) -> Self {
        Self { node, measurement: at, information, of: PriorOf::Position, kernel: None }
    }

    /// The residual `e`.
    pub fn residual(&self, pose: &G) -> SVector<f64, DOF> {
        match self.of {
            PriorOf::Pose => self.measurement.between(pose).log(),
            PriorOf::Position => translation(pose) - translation(&self.measurement),
        }
    }

    /// `e^T Omega e`.
    pub fn squared(&self, pose: &G) -> f64 {
        let error = self.residual(pose);
        error.dot(&(self.information * error))
    }

    /// `rho(e^T Omega e)` and the weight.
    pub(crate) fn charge(&self, pose: &G) -> (f64, f64) {
        charge(self.kernel, self.squared(pose))
    }

    /// The cost that rounding errors alone may cause: in `e^T Omega e`, and in the difference of far coordinates.
    pub(crate) fn rounding(&self, pose: &G) -> f64 {
        let error = self.residual(pose).abs();
        4.0 * f64::EPSILON * error.dot(&(self.information.abs() * error))
    }

    /// The quadratic model.
    pub(crate) fn linearise(&self, pose: &G) -> LinearisedPrior<DOF> {
        let error = self.residual(pose);
        let jacobian = match self.of {
            PriorOf::Pose => G::right_jacobian_inverse(&error),
            PriorOf::Position => turning(pose),
        };
        let weighted = self.information * error;
        let (cost, weight) = charge(self.kernel, error.dot(&weighted));
        LinearisedPrior {
            block: jacobian.tr_mul(&self.information) * jacobian * weight,
            gradient: jacobian.tr_mul(&weighted) * weight,
            cost,
        }
    }

    /// Checks the prior, whose index is `prior`, against the number of nodes.
    pub(crate) fn check(&self, prior: usize, nodes: usize) -> Result<(), PriorError> {
        let node = self.node;
        if node >= nodes {
            return Err(PriorError::MissingNode { prior, node, nodes });
        }
        let information = &self.information;
        if !is_finite(&self.measurement) || information.iter().any(|term| !term.is_finite()) {
            return Err(PriorError::NotFinite { prior, node });
        }
        if let Some(parameter) = self.kernel.map(Kernel::parameter).filter(|&p| !(p > 0.0 && p.is_finite())) {
            return Err(PriorError::KernelParameter { prior, parameter });
        }
        let weighs = |row: usize, column: usize| {
            row.max(column) >= translations(DOF) && information[(row, column)] != 0.0
        };
        if self.of == PriorOf::Position && (0..DOF).any(|row| (0..DOF).any(|column| weighs(row, column))) {
            return Err(PriorError::RotationOfPosition { prior, node });
        }
        let asymmetric = (information - information.transpose()).amax() > 1e-9 * information.amax();
        match definiteness(information) {
            Definiteness::PositiveDefinite | Definiteness::Semidefinite { .. } if !asymmetric => Ok(()),
            _ => Err(PriorError::NotSemidefinite { prior, node }),
        }
    }
}

/// The translation of a pose, with zeros for the rotation.
fn translation<G: LieGroup<DOF>, const DOF: usize>(pose: &G) -> SVector<f64, DOF> {
    let components = pose.components();
    SVector::from_fn(|axis, _| if axis < translations(DOF) { components[axis] } else { 0.0 })
}

/// `[R, 0; 0, 0]`: the adjoint of a pose begins with its rotation.
fn turning<G: LieGroup<DOF>, const DOF: usize>(pose: &G) -> SMatrix<f64, DOF, DOF> {
    let adjoint = pose.adjoint();
    SMatrix::from_fn(
        |row, column| {
            if row.max(column) < translations(DOF) { adjoint[(row, column)] } else { 0.0 }
        },
    )
}

/// The sum of `rho(e^T Omega e)` over priors; exactly zero without priors.
pub(crate) fn cost<G: LieGroup<DOF>, const DOF: usize>(priors: &[Prior<G, DOF>], poses: &[G]) -> f64 {
    priors.iter().fold(0.0, |sum, prior| sum + prior.charge(&poses[prior.node]).0)
}

/// The priors of each node.
pub(crate) struct PriorsOfNodes {
    /// Node and index of each prior, ascending.
    sorted: Vec<(usize, usize)>,
}

impl PriorsOfNodes {
    /// O(p log p).
    pub(crate) fn new<G, const DOF: usize>(priors: &[Prior<G, DOF>]) -> Self {
        let mut sorted: Vec<_> =
            priors.iter().enumerate().map(|(index, prior)| (prior.node, index)).collect();
        sorted.sort_unstable();
        Self { sorted }
    }

    /// The priors of a component's nodes, in the order of the nodes. O(n log p), and O(1) without priors.
    pub(crate) fn of_component<'a>(&'a self, component: &'a Component) -> impl Iterator<Item = usize> + 'a {
        let nodes = if self.sorted.is_empty() { &[][..] } else { &component.nodes };
        nodes.iter().flat_map(|&node| {
            let first = self.sorted.partition_point(|&(other, _)| other < node);
            let own = self.sorted[first..].iter().take_while(move |&&(other, _)| other == node);
            own.map(|&(_, index)| index)
        })
    }

    /// Whether any prior applies to a component.
    pub(crate) fn anchor(&self, component: &Component) -> bool {
        self.of_component(component).next().is_some()
    }
}

/// Whether the priors of a component leave it free to turn, whatever their numbers are: none measures a pose, and they measure
/// the positions of fewer nodes than fix a rigid body, two in the plane and three in space.
///
/// This is no test of rank: positions on a line in space, or information that is singular, are found by the factorisation.
pub(crate) fn leave_free<G, const DOF: usize>(priors: &[Prior<G, DOF>]) -> bool {
    let mut nodes: Vec<usize> = priors.iter().map(|prior| prior.node).collect();
    nodes.sort_unstable();
    nodes.dedup();
    !priors.is_empty()
        && priors.iter().all(|prior| prior.of == PriorOf::Position)
        && nodes.len() < translations(DOF)
}

#[cfg(test)]
mod tests {
    use super::*;
    use posecut_geometry::{SE2, SE3};

    /// Compares the model with central differences of the residual.
    fn check<G: LieGroup<DOF>, const DOF: usize>(pose: G, measurement: G) {
        let spread =
            SMatrix::<f64, DOF, DOF>::from_fn(|row, column| ((row * 7 + column * 3) % 5) as f64 * 0.1);
        let full = SMatrix::identity() + spread * spread.transpose();
        let flat =
            SMatrix::from_fn(
                |row, column| {
                    if row.max(column) < translations(DOF) { full[(row, column)] } else { 0.0 }
                },
            );
        for prior in [Prior::pose(0, measurement, full), Prior::position(0, measurement, flat)] {
            assert_eq!(prior.check(0, 1), Ok(()));
            let step = 1e-6;
            let mut jacobian = SMatrix::<f64, DOF, DOF>::zeros();
            for axis in 0..DOF {
                let at = |offset: f64| {
                    let mut tangent = SVector::<f64, DOF>::zeros();
                    tangent[axis] = offset;
                    prior.residual(&pose.compose(&G::exp(&tangent)))
                };
                jacobian.set_column(axis, &((at(step) - at(-step)) / (2.0 * step)));
            }
            let model = prior.linearise(&pose);
            let error = prior.residual(&pose);
            let block = jacobian.transpose() * prior.information * jacobian;
            assert!((model.block - block).amax() < 1e-7 * (1.0 + block.amax()), "{:?}", prior.of);
            let gradient = jacobian.transpose() * prior.information * error;
            assert!((model.gradient - gradient).amax() < 1e-7 * (1.0 + gradient.amax()), "{:?}", prior.of);
            assert!((model.cost - prior.squared(&pose)).abs() < 1e-12 * model.cost);
        }
    }

    #[test]
    fn models_match_finite_differences() {
        check(SE2::new(3.0, -1.0, 2.9), SE2::new(1.5, -2.0, -2.4));
        check(
            SE3::from_euler(-1.0, 0.5, 2.0, -0.6, 1.1, -2.0),
            SE3::from_euler(1.0, 1.0, 0.5, 0.2, 0.1, -0.4),
        );
    }
}

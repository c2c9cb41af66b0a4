//! The factorised equations of a connected component, and the blocks of the covariance that they give at once.

use nalgebra::SMatrix;
use posecut_cholesky::{Factor, SelectedInverse, Symbolic};

use crate::model::lanes::LaneGroup;
use crate::model::prior::Prior;
use crate::model::problem::Edge;
use crate::normal_equations::{Pattern, System};

/// Two nodes by their numbers in a component.
pub(super) struct Place {
    pub(super) part: usize,
    pub(super) a: usize,
    pub(super) b: usize,
}

impl Place {
    /// Row and column, smaller first, of the three blocks of a [`Joint`]: first, cross, second.
    pub(super) fn blocks(&self) -> [(usize, usize); 3] {
        let Self { a, b, .. } = *self;
        [(a, a), (a.min(b), a.max(b)), (b, b)]
    }
}

pub(super) type Block<const DOF: usize> = SMatrix<f64, DOF, DOF>;

/// The factorised equations of a connected component.
pub(super) struct Part<const DOF: usize> {
    pub(super) held: usize,
    pub(super) symbolic: Symbolic,
    pub(super) factor: Factor<DOF>,
    pub(super) inverse: Option<SelectedInverse<DOF>>,
    /// Node and component that the edges leave undetermined.
    pub(super) undetermined: Option<(usize, usize)>,
}

impl<const DOF: usize> Part<DOF> {
    pub(super) fn new<G: LaneGroup<DOF>>(
        poses: &[G],
        edges: &[Edge<G, DOF>],
        priors: &[Prior<G, DOF>],
        system: System<DOF>,
    ) -> Self {
        let System { pattern, mut equations, memory } = system;
        let cost = equations.assemble(&pattern, edges, poses);
        equations.add_priors(pattern.held, priors, poses, cost);
        let Pattern { held, symbolic, .. } = pattern;
        let mut factor = Factor::with_memory(&symbolic, memory);
        let outcome =
            factor.factorize(&symbolic, &equations.diagonal, &equations.off_diagonal, 0.0, [0.0; DOF]);
        let undetermined = match outcome {
            Err(breakdown) => Some((breakdown.variable, breakdown.component)),
            Ok(()) => factor.undetermined(),
        };
        let undetermined = undetermined.map(|(variable, component)| (held + variable, component));
        Self { held, symbolic, factor, inverse: None, undetermined }
    }

    /// The block of the covariance of two nodes where it costs nothing: held nodes have no uncertainty, and the inverse has
    /// the blocks of the factor.
    pub(super) fn block(&self, row: usize, column: usize) -> Option<Block<DOF>> {
        match row.checked_sub(self.held).zip(column.checked_sub(self.held)) {
            Some((row, column)) => self.inverse.as_ref()?.block(&self.symbolic, row, column),
            None => Some(SMatrix::zeros()),
        }
    }
}

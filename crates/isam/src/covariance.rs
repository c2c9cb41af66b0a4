//! Marginal covariances of single poses.

use std::collections::HashMap;

use nalgebra::SMatrix;

use crate::tree::{Clique, NONE};
use crate::{IncrementalGroup, IncrementalSolver};

/// Rows of a right-hand side with one column for each component of a pose, by node.
type Rows<const D: usize> = HashMap<usize, SMatrix<f64, D, D>>;

impl<G: IncrementalGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// The covariance of a right perturbation of a pose, given its component's fixed poses, as of the last update: the pose's
    /// diagonal block of the inverse normal equations. Zero for a fixed pose; `None` for a pose that was marginalised, does not
    /// exist or has not been part of an update. Directions that the edges leave undetermined have no meaning.
    ///
    /// Takes one substitution forward and back along the pose's path to the root of the tree.
    pub fn covariance(&self, pose: usize) -> Option<SMatrix<f64, DOF, DOF>> {
        G::covariance(self, pose)
    }

    pub(crate) fn covariance_here(&self, pose: usize) -> Option<SMatrix<f64, DOF, DOF>> {
        if pose >= self.poses() || self.gauges.is_marginalised(pose) {
            return None;
        }
        if self.gauges.fixed[pose] {
            return Some(SMatrix::zeros());
        }
        let mut path = Vec::new();
        let mut index = self.tree.of[pose];
        while index != NONE {
            path.push(index);
            index = self.tree.clique(index).parent;
        }
        let mut rows = Rows::from([(pose, SMatrix::identity())]);
        for &index in &path {
            forward(self.tree.clique(index), &mut rows);
        }
        for &index in path.iter().rev() {
            backward(self.tree.clique(index), &mut rows);
        }
        rows.remove(&pose).filter(|_| !path.is_empty())
    }
}

/// The block of the clique's panel at the variables in these positions.
fn block<const D: usize>(clique: &Clique, row: usize, column: usize) -> SMatrix<f64, D, D> {
    let height = clique.variables.len() * D + 1;
    SMatrix::from_fn(|i, j| clique.panel[(column * D + j) * height + row * D + i])
}

/// The lower triangle of the diagonal block, inverted.
fn inverse<const D: usize>(clique: &Clique, place: usize) -> SMatrix<f64, D, D> {
    let mut lower = block::<D>(clique, place, place);
    lower.fill_upper_triangle(0.0, 1);
    let mut inverse = SMatrix::identity();
    lower.solve_lower_triangular_mut(&mut inverse);
    inverse
}

/// `y_1 = L^-1 b_1`, `b_2 -= M y_1`.
fn forward<const D: usize>(clique: &Clique, rows: &mut Rows<D>) {
    for place in 0..clique.frontals {
        let node = clique.variables[place];
        let Some(right) = rows.get(&node).copied() else { continue };
        let value = inverse::<D>(clique, place) * right;
        rows.insert(node, value);
        for (below, &other) in clique.variables.iter().enumerate().skip(place + 1) {
            *rows.entry(other).or_insert_with(SMatrix::zeros) -= block::<D>(clique, below, place) * value;
        }
    }
}

/// `x_1 = L^-T (y_1 - M^T x_2)`.
fn backward<const D: usize>(clique: &Clique, rows: &mut Rows<D>) {
    for place in (0..clique.frontals).rev() {
        let node = clique.variables[place];
        let mut value = rows.get(&node).copied().unwrap_or_else(SMatrix::zeros);
        for (below, other) in clique.variables.iter().enumerate().skip(place + 1) {
            if let Some(known) = rows.get(other) {
                value -= block::<D>(clique, below, place).tr_mul(known);
            }
        }
        rows.insert(node, inverse::<D>(clique, place).tr_mul(&value));
    }
}

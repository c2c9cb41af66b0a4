//! What marginalised poses leave behind: a quadratic cost over the poses around them.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use posecut_geometry::LieGroup;

use crate::estimate::Estimate;
use crate::tree::Clique;

/// A measurement of several poses relative to one of them, the anchor `a`, with one information matrix:
/// `e^T H e - 2 b^T e + c` with `e_i = Log(Z_i^-1 X_a^-1 X_i)`. With a single other pose it is an ordinary edge.
///
/// `Z_i` are the relative poses at the points of linearisation when the past was marginalised. They are frozen; the residual
/// is expanded anew wherever the poses are linearised. Relative poses make the cost exactly invariant: a motion of all its
/// poses together changes nothing, as it changed nothing in the edges that were marginalised.
#[derive(Clone, Debug)]
pub(crate) struct Prior<G, const DOF: usize> {
    /// The anchor, then the other poses.
    pub(crate) nodes: Vec<usize>,
    /// `Z_i`, without the anchor.
    relative: Vec<G>,
    /// `H`.
    matrix: DMatrix<f64>,
    /// `b`.
    vector: DVector<f64>,
    /// `c`.
    pub(crate) constant: f64,
}

impl<G: LieGroup<DOF>, const DOF: usize> Prior<G, DOF> {
    /// Freezes a quadratic model at these points: the update matrix of a clique without frontal variables, whose last row is
    /// `b^T`. The block of the anchor follows from the others, because the model is invariant or the anchor is a constant.
    pub(crate) fn freeze(model: &Clique, anchor: usize, points: &[G]) -> Self {
        let order = model.variables.len() * DOF + 1;
        let others: Vec<usize> =
            (0..model.variables.len()).filter(|&place| model.variables[place] != anchor).collect();
        let size = others.len() * DOF;
        let row = |index: usize| others[index / DOF] * DOF + index % DOF;
        // Only the lower triangle of an update matrix is valid.
        let matrix = DMatrix::from_fn(size, size, |i, j| {
            let (low, high) = (row(i).min(row(j)), row(i).max(row(j)));
            model.update[low * order + high]
        });
        let vector = DVector::from_fn(size, |i, _| model.update[row(i) * order + order - 1]);
        let nodes: Vec<usize> =
            std::iter::once(anchor).chain(others.iter().map(|&place| model.variables[place])).collect();
        let relative = nodes[1..].iter().map(|&node| points[anchor].between(&points[node])).collect();
        Self { nodes, relative, matrix, vector, constant: 0.0 }
    }

    /// `e`.
    fn residual(&self, pose: impl Fn(usize) -> G) -> DVector<f64> {
        let anchor = pose(self.nodes[0]);
        let mut all = DVector::zeros(self.vector.len());
        for (place, (&node, measured)) in self.nodes[1..].iter().zip(&self.relative).enumerate() {
            let error = measured.between(&anchor.between(&pose(node))).log();
            all.fixed_rows_mut::<DOF>(place * DOF).copy_from(&error);
        }
        all
    }

    /// The cost at these poses. O(poses^2).
    pub(crate) fn cost(&self, pose: impl Fn(usize) -> G) -> f64 {
        let error = self.residual(pose);
        error.dot(&(&self.matrix * &error - 2.0 * &self.vector)) + self.constant
    }

    /// Sets the constant so that the cost at the estimate has this value.
    pub(crate) fn set_cost(&mut self, cost: f64, estimate: &Estimate<G, DOF>) {
        self.constant = 0.0;
        self.constant = cost - self.cost(|node| estimate.pose(node));
    }

    /// The start of a batch solution: the relative poses as edges from the anchor, with the diagonal blocks of `H`.
    pub(crate) fn star(&self) -> impl Iterator<Item = (usize, usize, G, SMatrix<f64, DOF, DOF>)> + '_ {
        let others = self.nodes[1..].iter().zip(&self.relative).enumerate();
        others.map(|(place, (&node, &measured))| {
            let block = self.matrix.fixed_view::<DOF, DOF>(place * DOF, place * DOF).into_owned();
            (self.nodes[0], node, measured, block)
        })
    }

    /// Expands the residual at these points and writes the quadratic model into a clique without frontal variables, for the
    /// poses that `includes` selects; the others are constants. O(poses^2).
    ///
    /// With `R_i = J_r^-1(e_i)` and `F_i = -R_i Ad(X_i^-1 X_a)`, the derivatives by `X_i` and `X_a`, the blocks are
    /// `R_i^T H_ij R_j`, `R_i^T (H F)_i` and `F^T H F`, and the right-hand sides `R_i^T r_i` and `F^T r` with `r = b - H e`.
    pub(crate) fn expand(&self, points: &[G], includes: impl Fn(usize) -> bool, clique: &mut Clique) {
        let error = self.residual(|node| points[node]);
        let rest = &self.vector - &self.matrix * &error;
        let anchor = &points[self.nodes[0]];
        let size = self.vector.len();
        let mut by_anchor = DMatrix::<f64>::zeros(size, DOF);
        let mut derivatives: Vec<SMatrix<f64, DOF, DOF>> = Vec::with_capacity(size / DOF);
        for (place, &node) in self.nodes[1..].iter().enumerate() {
            let at: SVector<f64, DOF> = error.fixed_rows::<DOF>(place * DOF).into_owned();
            let derivative = G::right_jacobian_inverse(&at);
            let opposite = -derivative * points[node].between(anchor).adjoint();
            by_anchor.fixed_rows_mut::<DOF>(place * DOF).copy_from(&opposite);
            derivatives.push(derivative);
        }
        clique.variables.clear();
        clique.variables.extend(self.nodes.iter().copied().filter(|&node| includes(node)));
        let order = clique.variables.len() * DOF + 1;
        clique.update.clear();
        clique.update.resize(order * order, 0.0);
        let has_anchor = includes(self.nodes[0]);
        let kept: Vec<usize> =
            (0..derivatives.len()).filter(|&place| includes(self.nodes[place + 1])).collect();
        let mut target = Target { values: &mut clique.update, order };
        if has_anchor {
            let product = &self.matrix * &by_anchor;
            target.set::<DOF>(0, 0, &(by_anchor.tr_mul(&product)).fixed_view::<DOF, DOF>(0, 0).into_owned());
            target.set_right::<DOF>(0, &by_anchor.tr_mul(&rest).fixed_rows::<DOF>(0).into_owned());
            for (offset, &place) in kept.iter().enumerate() {
                let block = product.fixed_view::<DOF, DOF>(place * DOF, 0);
                target.set::<DOF>(offset + 1, 0, &derivatives[place].tr_mul(&block));
            }
        }
        let first = usize::from(has_anchor);
        for (column, &place) in kept.iter().enumerate() {
            let right = &derivatives[place];
            target.set_right::<DOF>(
                first + column,
                &right.tr_mul(&rest.fixed_rows::<DOF>(place * DOF).into_owned()),
            );
            for (row, &other) in kept.iter().enumerate().skip(column) {
                let block = self.matrix.fixed_view::<DOF, DOF>(other * DOF, place * DOF);
                target.set::<DOF>(first + row, first + column, &(derivatives[other].tr_mul(&block) * right));
            }
        }
    }

    /// Adds half the gradient at these poses, and the diagonal of the quadratic model, to those of each node.
    pub(crate) fn add_to(&self, equations: &mut [[SVector<f64, DOF>; 2]], poses: &[G]) {
        let mut model = Clique::default();
        self.expand(poses, |_| true, &mut model);
        let order = model.variables.len() * DOF + 1;
        let columns = model.update.chunks_exact(order).take(order - 1).enumerate();
        for (index, column) in columns {
            let [gradient, diagonal] = &mut equations[model.variables[index / DOF]];
            gradient[index % DOF] -= column[order - 1];
            diagonal[index % DOF] += column[index];
        }
    }

    /// Memory used, scalars.
    pub(crate) fn scalars(&self) -> usize {
        self.matrix.len() + self.vector.len()
    }
}

/// An update matrix: column-major, with the right-hand side as its last row.
struct Target<'a> {
    values: &'a mut [f64],
    order: usize,
}

impl Target<'_> {
    fn set<const DOF: usize>(&mut self, row: usize, column: usize, block: &SMatrix<f64, DOF, DOF>) {
        for (offset, source) in block.as_slice().chunks_exact(DOF).enumerate() {
            let start = (column * DOF + offset) * self.order + row * DOF;
            self.values[start..start + DOF].copy_from_slice(source);
        }
    }

    fn set_right<const DOF: usize>(&mut self, column: usize, values: &SVector<f64, DOF>) {
        for (offset, &value) in values.iter().enumerate() {
            self.values[(column * DOF + offset + 1) * self.order - 1] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posecut_geometry::{SE2, SE3};

    /// A prior over three poses and others far from those that it is frozen at.
    fn prior<G: LieGroup<DOF>, const DOF: usize>(points: &[G]) -> Prior<G, DOF> {
        let order = 3 * DOF + 1;
        let entry = |i: usize, j: usize| ((i * 7 + j * 5 + i * j) % 11) as f64 * 0.1 - 0.4;
        let root = DMatrix::from_fn(order, order, entry);
        let update = (&root * root.transpose() + DMatrix::identity(order, order)).as_slice().to_vec();
        let mut model = Clique::default();
        model.variables = vec![0, 1, 2];
        model.update = update;
        Prior::freeze(&model, 1, points)
    }

    /// Compares the gradient of the expansion with central differences of the cost, and checks the invariance.
    fn check<G: LieGroup<DOF>, const DOF: usize>(frozen: &[G], poses: &[G]) {
        let prior = prior::<G, DOF>(frozen);
        let mut model = Clique::default();
        prior.expand(poses, |_| true, &mut model);
        assert_eq!(model.variables, [1, 0, 2]);
        let order = 3 * DOF + 1;
        for index in 0..3 * DOF {
            let node = model.variables[index / DOF];
            let at =
                |offset: f64| {
                    let mut tangent = SVector::<f64, DOF>::zeros();
                    tangent[index % DOF] = offset;
                    prior.cost(|other| {
                        if other == node { poses[other].compose(&G::exp(&tangent)) } else { poses[other] }
                    })
                };
            let half_gradient = (at(1e-5) - at(-1e-5)) / 4e-5;
            let found = -model.update[index * order + order - 1];
            assert!(
                (found - half_gradient).abs() < 1e-6 * (1.0 + half_gradient.abs()),
                "{index}: {found} {half_gradient}"
            );
        }
        // A constant pose leaves out its rows and columns, and nothing else.
        let mut part = Clique::default();
        prior.expand(poses, |node| node != 0, &mut part);
        assert_eq!(part.variables, [1, 2]);
        let row = |index: usize| if index < DOF { index } else { index + DOF };
        for column in 0..2 * DOF {
            for index in column..=2 * DOF {
                let (small, large) = (
                    part.update[column * (2 * DOF + 1) + index],
                    model.update[row(column) * order + row(index)],
                );
                assert!(small.to_bits() == large.to_bits(), "{column} {index}: {small} {large}");
            }
        }
        let motion = poses[0].compose(&frozen[2]);
        let moved = prior.cost(|node| motion.compose(&poses[node]));
        let still = prior.cost(|node| poses[node]);
        assert!((moved - still).abs() < 1e-9 * still.abs(), "{moved} {still}");
    }

    #[test]
    fn expansions_match_finite_differences() {
        let frozen = [SE2::new(1.0, 2.0, 0.3), SE2::new(-1.0, 0.5, -2.9), SE2::new(3.0, 1.0, 3.0)];
        let poses = [SE2::new(1.3, 1.8, 0.7), SE2::new(-0.6, 0.1, -2.5), SE2::new(2.5, 1.2, -3.1)];
        check::<SE2, 3>(&frozen, &poses);
        let spatial = |offset: f64| {
            let pose = |k: f64| {
                SE3::from_euler(k, 1.0 - k, 0.5 * k, 0.4 * k + offset, -0.3 + offset, 0.9 * k - offset)
            };
            [pose(0.3), pose(-1.2), pose(2.1)]
        };
        check::<SE3, 6>(&spatial(0.0), &spatial(0.2));
    }
}

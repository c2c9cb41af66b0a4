//! Poses in more dimensions: a translation, and axes of length one at right angles.
//!
//! A block `[t Y]` has `P` rows. Its tangents `[u U]` have a symmetric part `Y^T U` of zero (P.-A. Absil, R. Mahony, R. Sepulchre,
//! "Optimization algorithms on matrix manifolds", 2008, section 3.5.7).

use nalgebra::SMatrix;

/// A block per pose.
pub(super) type Lift<const P: usize, const M: usize> = Vec<SMatrix<f64, P, M>>;

/// Projects `u` to the tangents at `x`: `U - Y sym(Y^T U)`; translations stay the same.
pub(super) fn project<const N: usize, const M: usize, const P: usize>(x: &Lift<P, M>, u: &mut Lift<P, M>) {
    for (x, u) in x.iter().zip(u) {
        let axes = x.fixed_columns::<N>(1);
        let inner = symmetric(&axes.tr_mul(&u.fixed_columns::<N>(1)));
        let mut turned = u.fixed_columns_mut::<N>(1);
        turned -= axes * inner;
    }
}

/// Moves `x` along the tangent `u`.
pub(super) fn retract<const M: usize, const P: usize>(x: &Lift<P, M>, u: &Lift<P, M>) -> Lift<P, M> {
    x.iter().zip(u).map(|(x, u)| orthonormalise(x + u)).collect()
}

/// The multipliers of the constraints, `sym(Y^T G)`, for half the gradient `G`.
pub(super) fn multipliers<const N: usize, const M: usize, const P: usize>(
    x: &Lift<P, M>,
    gradient: &Lift<P, M>,
) -> Vec<SMatrix<f64, N, N>> {
    let inner = |(x, g): (&SMatrix<f64, P, M>, &SMatrix<f64, P, M>)| {
        symmetric(&x.fixed_columns::<N>(1).tr_mul(&g.fixed_columns::<N>(1)))
    };
    x.iter().zip(gradient).map(inner).collect()
}

/// Gram and Schmidt's orthonormalisation of the axes.
pub(super) fn orthonormalise<const M: usize, const P: usize>(
    mut block: SMatrix<f64, P, M>,
) -> SMatrix<f64, P, M> {
    for axis in 1..M {
        let mut column = block.column(axis).into_owned();
        for before in 1..axis {
            let other = block.column(before).into_owned();
            column -= other * other.dot(&column);
        }
        let length = column.norm();
        block.set_column(axis, &(column / length));
    }
    block
}

/// The inner product.
pub(super) fn dot<const M: usize, const P: usize>(a: &Lift<P, M>, b: &Lift<P, M>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// Adds a multiple.
pub(super) fn add<const M: usize, const P: usize>(to: &mut Lift<P, M>, factor: f64, what: &Lift<P, M>) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += what * factor);
}

fn symmetric<const N: usize>(matrix: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    (matrix + matrix.transpose()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(seed: f64) -> SMatrix<f64, 4, 3> {
        SMatrix::from_fn(|row, column| (seed + (row * 3 + column) as f64 * 1.7).sin())
    }

    #[test]
    fn a_tangent_keeps_axes_orthonormal_to_first_order_and_a_retraction_exactly() {
        let x = vec![orthonormalise(block(0.3)), orthonormalise(block(2.0))];
        let mut u = vec![block(5.0), block(-1.0)];
        project::<2, 3, 4>(&x, &mut u);
        for (x, u) in x.iter().zip(&u) {
            let inner = x.fixed_columns::<2>(1).tr_mul(&u.fixed_columns::<2>(1));
            assert!((inner + inner.transpose()).amax() < 1e-14, "{inner}");
        }
        for moved in retract(&x, &u) {
            let axes = moved.fixed_columns::<2>(1);
            assert!((axes.tr_mul(&axes) - SMatrix::<f64, 2, 2>::identity()).amax() < 1e-14);
        }
    }
}

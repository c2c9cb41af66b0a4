//! Minimises `tr(X M X^T)` over poses in more dimensions.
//!
//! A Riemannian trust-region method whose steps come from preconditioned conjugate gradients that end at the region's boundary or at a
//! direction of negative curvature (P.-A. Absil, C. G. Baker, K. A. Gallivan, "Trust-region methods on Riemannian manifolds", 2007).

use nalgebra::SMatrix;

use super::manifold::{Lift, add, dot, multipliers, project, retract};
use super::places::Places;
use super::preconditioner::Preconditioner;
use crate::certificate::chordal_matrix::ChordalMatrix;
use crate::descent::truncation::Lengths;
use crate::effort::Effort;

/// Maximum numbers of steps, and of directions for one step.
const STEPS: usize = 100;
const DIRECTIONS: usize = 40;
/// The iteration ends when a step lowers the cost by less than this share, or could at most by its square, by the gradient. With 1e-4, M3500
/// with 0.4 rad of noise ends up to 3 % higher.
const TOLERANCE: f64 = 1e-5;
/// The directions end when the residual falls below this share of the gradient, squares in the norm of the preconditioner.
const REDUCTION: f64 = 1e-2;
/// Ratios of gain to promise: below the first the radius shrinks, above the second it grows, below the last the step is not taken.
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;
const TAKEN: f64 = 0.05;
/// A radius below this share of the first one is rounding.
const SMALLEST: f64 = 1e-10;

/// A step and its product with the Hessian.
struct Proposal<const P: usize, const M: usize> {
    step: Lift<P, M>,
    product: Lift<P, M>,
    /// Whether all directions were used up.
    is_rough: bool,
}

/// The result from this start, or what it has come to once the effort is spent; `None` if the matrix is singular or the cost not finite.
pub(super) fn minimise<const N: usize, const M: usize, const P: usize, const T: usize>(
    matrix: &ChordalMatrix<M>,
    start: Lift<P, M>,
    effort: &mut Effort,
) -> Option<Lift<P, M>> {
    let mut places = Places::new(matrix)?;
    let mut preconditioner = Preconditioner::<P, M, T>::new(matrix)?;
    let mut x = start;
    places.put(matrix, &mut x);
    let mut x_m = matrix.times(&x);
    let mut cost = dot(&x, &x_m);
    let mut radius = f64::NAN;
    let mut is_new = true;
    let mut smallest = 0.0;
    for _ in 0..STEPS {
        let mut gradient = x_m.clone();
        project::<N, M, P>(&x, &mut gradient);
        if effort.is_spent() || (is_new && !preconditioner.move_to(matrix, &x, effort)) {
            break;
        }
        let first = preconditioner.divide::<N>(matrix, &x, &gradient, effort);
        let size = dot(&first, &gradient);
        if !size.is_finite() {
            return None;
        }
        if size <= TOLERANCE * TOLERANCE * cost {
            break;
        }
        if radius.is_nan() {
            radius = 4.0 * size.sqrt();
            smallest = SMALLEST * radius;
        }
        let at = Point { matrix, x: &x, multipliers: multipliers::<N, M, P>(&x, &x_m) };
        let Proposal { step, product, is_rough } =
            at.directions(&mut preconditioner, &gradient, &first, radius, effort);
        let promised = -2.0 * dot(&gradient, &step) - dot(&step, &product);
        let mut trial = retract(&x, &step);
        places.put(matrix, &mut trial);
        let trial_m = matrix.times(&trial);
        let trial_cost = dot(&trial, &trial_m);
        let gain = (cost - trial_cost) / promised;
        if !(gain >= POOR) {
            radius *= 0.25;
        } else if gain > GOOD {
            radius *= 2.0;
        }
        let comes_closer = is_rough && preconditioner.come_closer(matrix, effort);
        if comes_closer {
            // Lengths have another unit from here on.
            radius = f64::NAN;
        }
        is_new = comes_closer || gain > TAKEN;
        if gain > TAKEN {
            let change = cost - trial_cost;
            (x, x_m, cost) = (trial, trial_m, trial_cost);
            if change < TOLERANCE * cost && !comes_closer {
                break;
            }
        }
        if radius < smallest {
            break;
        }
    }
    Some(x)
}

/// A point and the multipliers of its constraints.
struct Point<'a, const N: usize, const M: usize, const P: usize> {
    matrix: &'a ChordalMatrix<M>,
    x: &'a Lift<P, M>,
    multipliers: Vec<SMatrix<f64, N, N>>,
}

impl<const N: usize, const M: usize, const P: usize> Point<'_, N, M, P> {
    /// The Hessian of half the cost times a tangent: the projection of `U M - U Lambda`.
    fn hessian(&self, u: &Lift<P, M>) -> Lift<P, M> {
        let mut product = self.matrix.times(u);
        for ((product, u), multiplier) in product.iter_mut().zip(u).zip(&self.multipliers) {
            let mut turned = product.fixed_columns_mut::<N>(1);
            turned -= u.fixed_columns::<N>(1) * multiplier;
        }
        project::<N, M, P>(self.x, &mut product);
        product
    }

    /// Truncated conjugate gradients. `first` is the preconditioned gradient; lengths are in the norm of the preconditioner.
    fn directions<const T: usize>(
        &self,
        preconditioner: &mut Preconditioner<P, M, T>,
        gradient: &Lift<P, M>,
        first: &Lift<P, M>,
        radius: f64,
        effort: &mut Effort,
    ) -> Proposal<P, M> {
        let zero = vec![SMatrix::<f64, P, M>::zeros(); self.x.len()];
        let mut found = Proposal { step: zero.clone(), product: zero, is_rough: true };
        let mut residual = gradient.clone();
        let mut decrease = dot(first, &residual);
        let enough = REDUCTION * decrease;
        let mut direction: Lift<P, M> = first.iter().map(|block| -block).collect();
        let mut lengths = Lengths::new(decrease, radius);
        for _ in 0..DIRECTIONS {
            let product = self.hessian(&direction);
            let curvature = dot(&direction, &product);
            let length = decrease / curvature;
            if let Some(to_boundary) = lengths.boundary(length, curvature) {
                add(&mut found.step, to_boundary, &direction);
                add(&mut found.product, to_boundary, &product);
                found.is_rough = false;
                break;
            }
            add(&mut found.step, length, &direction);
            add(&mut found.product, length, &product);
            add(&mut residual, length, &product);
            let preconditioned = preconditioner.divide::<N>(self.matrix, self.x, &residual, effort);
            let next = dot(&preconditioned, &residual);
            if !(next > enough) {
                found.is_rough = false;
                break;
            }
            let ratio = next / decrease;
            decrease = next;
            for (direction, preconditioned) in direction.iter_mut().zip(&preconditioned) {
                *direction = *direction * ratio - preconditioned;
            }
            lengths.turn(length, decrease, ratio);
        }
        found
    }
}

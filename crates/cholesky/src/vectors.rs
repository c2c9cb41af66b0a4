//! Vectors of blocks, for iterations with a factor as the preconditioner.

use nalgebra::SVector;

/// The scalar product.
pub fn dot<const D: usize>(a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// `to += factor * what`.
pub fn add<const D: usize>(to: &mut [SVector<f64, D>], factor: f64, what: &[SVector<f64, D>]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += what * factor);
}

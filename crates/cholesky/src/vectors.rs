//! Vectors of blocks, for iterations with a factor as the preconditioner, and vector instructions for small blocks.

use nalgebra::SVector;
use pulp::Arch;

/// The vector instructions for loops over small blocks: AVX2 where AVX-512 exists, too, whose longer vectors make these loops some percent
/// slower.
pub fn for_small_blocks() -> Arch {
    match Arch::new() {
        #[cfg(target_arch = "x86_64")]
        Arch::V4(simd) => Arch::V3(*simd),
        other => other,
    }
}

/// The scalar product.
pub fn dot<const D: usize>(a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// `to += factor * what`.
pub fn add<const D: usize>(to: &mut [SVector<f64, D>], factor: f64, what: &[SVector<f64, D>]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += what * factor);
}

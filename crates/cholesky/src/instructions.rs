//! Vector instructions for loops over small blocks.

#[cfg(not(target_arch = "x86_64"))]
use pulp::Arch;
use pulp::WithSimd;
#[cfg(target_arch = "x86_64")]
use pulp::{Scalar, Simd, x86::V3};

/// Runs loops over small blocks with the vector instructions of this machine: AVX2 where AVX-512 exists, too, whose longer vectors make
/// these loops some percent slower. They are not even compiled for AVX-512, which would take a third of the time of compiling them.
pub fn for_small_blocks<Loops: WithSimd>(loops: Loops) -> Loops::Output {
    #[cfg(target_arch = "x86_64")]
    return match V3::try_new() {
        Some(simd) => Simd::vectorize(simd, loops),
        None => Simd::vectorize(Scalar, loops),
    };
    #[cfg(not(target_arch = "x86_64"))]
    Arch::new().dispatch(loops)
}

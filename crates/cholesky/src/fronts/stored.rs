//! The numbers that a factor is stored in. Elimination computes in double precision in any case.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use bytemuck::Pod;

/// A stored number: `f64`, or `f32` in half the memory.
pub trait Stored: Pod + Send + Sync {
    /// The same number in double precision.
    fn widened(self) -> f64;

    /// How large a workspace the elimination of a panel of this size takes.
    fn workspace(panel: usize) -> usize;

    /// Where to eliminate a panel: in place, or in the workspace, with the place to store the result.
    fn places<'a>(panel: &'a mut [Self], workspace: &'a mut [f64])
    -> (&'a mut [f64], Option<&'a mut [Self]>);

    /// Stores a number; those outside the range become zero or infinite.
    fn narrowed(value: f64) -> Self;
}

impl Stored for f64 {
    #[inline(always)]
    fn widened(self) -> f64 {
        self
    }

    fn workspace(_: usize) -> usize {
        0
    }

    #[inline(always)]
    fn places<'a>(panel: &'a mut [Self], _: &'a mut [f64]) -> (&'a mut [f64], Option<&'a mut [Self]>) {
        (panel, None)
    }

    #[inline(always)]
    fn narrowed(value: f64) -> Self {
        value
    }
}

impl Stored for f32 {
    #[inline(always)]
    fn widened(self) -> f64 {
        f64::from(self)
    }

    fn workspace(panel: usize) -> usize {
        panel
    }

    #[inline(always)]
    fn places<'a>(
        panel: &'a mut [Self],
        workspace: &'a mut [f64],
    ) -> (&'a mut [f64], Option<&'a mut [Self]>) {
        (&mut workspace[..panel.len()], Some(panel))
    }

    #[inline(always)]
    fn narrowed(value: f64) -> Self {
        value as Self
    }
}

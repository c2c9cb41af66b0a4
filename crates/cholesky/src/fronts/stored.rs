//! The numbers that a factor is stored in. Elimination computes in double precision in any case.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

/// A stored number: `f64`, or `f32` in half the memory.
pub trait Stored: Copy + Default + Send + Sync {
    /// The same number in double precision.
    fn widened(self) -> f64;

    /// Where to eliminate a panel: in place, or in the workspace, with the place to store the result.
    fn places<'a>(
        panel: &'a mut [Self],
        workspace: &'a mut Vec<f64>,
    ) -> (&'a mut [f64], Option<&'a mut [Self]>);

    /// Stores a number; those outside the range become zero or infinite.
    fn narrowed(value: f64) -> Self;
}

impl Stored for f64 {
    #[inline(always)]
    fn widened(self) -> f64 {
        self
    }

    #[inline(always)]
    fn places<'a>(panel: &'a mut [Self], _: &'a mut Vec<f64>) -> (&'a mut [f64], Option<&'a mut [Self]>) {
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

    #[inline(always)]
    fn places<'a>(
        panel: &'a mut [Self],
        workspace: &'a mut Vec<f64>,
    ) -> (&'a mut [f64], Option<&'a mut [Self]>) {
        if workspace.len() < panel.len() {
            workspace.resize(panel.len(), 0.0);
        }
        (&mut workspace[..panel.len()], Some(panel))
    }

    #[inline(always)]
    fn narrowed(value: f64) -> Self {
        value as Self
    }
}

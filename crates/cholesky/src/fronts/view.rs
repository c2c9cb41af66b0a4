//! A dense front during assembly and elimination.

/// The memory of a front: its columns and its update matrix, both column-major. Only lower triangles are valid.
#[derive(Debug)]
pub struct FrontView<'a> {
    /// The columns to eliminate, `[A; B]`, which become `[L; M]` with `L L^T = A`, `M = B L^-T`.
    pub panel: &'a mut [f64],
    /// Rows of the panel.
    pub height: usize,
    /// Columns of the panel.
    pub columns: usize,
    /// The update matrix, of order `height - columns`: elimination subtracts `M M^T` from it.
    pub update: &'a mut [f64],
    /// Whether the update is still empty: elimination then sets it to `-M M^T` and ignores its content.
    pub fresh: bool,
}

impl FrontView<'_> {
    /// Order of the update matrix.
    #[inline]
    pub fn below(&self) -> usize {
        self.height - self.columns
    }

    /// The same front with a shorter lifetime. Passed by value, so that its fields stay in registers in inlined calls.
    #[inline]
    pub fn reborrow(&mut self) -> FrontView<'_> {
        let Self { panel, height, columns, update, fresh } = self;
        FrontView { panel, height: *height, columns: *columns, update, fresh: *fresh }
    }
}

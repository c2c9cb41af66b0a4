//! A dense front while it is assembled and eliminated.

/// The memory of a front: its columns and what they leave, both column-major. Only lower triangles are meant.
#[derive(Debug)]
pub struct FrontView<'a> {
    /// The columns to eliminate, `[A; B]`, which become `[L; M]` with `L L^T = A`, `M = B L^-T`.
    pub panel: &'a mut [f64],
    /// Rows of the panel.
    pub height: usize,
    /// Columns of the panel.
    pub columns: usize,
    /// The update matrix, of order `height - columns`: what elimination reduces by `M M^T`.
    pub update: &'a mut [f64],
    /// Whether nothing is in the update yet: it becomes `-M M^T` whatever it holds.
    pub fresh: bool,
}

impl FrontView<'_> {
    /// Order of the update matrix.
    #[inline]
    pub fn below(&self) -> usize {
        self.height - self.columns
    }

    /// The same front, for a shorter time. Passed by value, so that its parts stay in registers where calls are inlined.
    #[inline]
    pub fn reborrow(&mut self) -> FrontView<'_> {
        let Self { panel, height, columns, update, fresh } = self;
        FrontView { panel, height: *height, columns: *columns, update, fresh: *fresh }
    }
}

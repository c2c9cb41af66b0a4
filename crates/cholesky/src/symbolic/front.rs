//! Fronts: their position in memory, and their columns, rows and children.

use std::ops::Range;

/// No parent front.
pub(crate) const NO_PARENT: usize = usize::MAX;

/// One dense front of the multifrontal method. Sizes and offsets count blocks.
#[derive(Debug)]
pub(crate) struct Front {
    /// First column, in elimination order.
    pub(crate) first: usize,
    /// Columns eliminated here.
    pub(crate) columns: usize,
    /// Range in [`Symbolic::rows`] of the rows below.
    pub(crate) rows: Range<usize>,
    /// Front that takes the update, or [`NO_PARENT`].
    pub(crate) parent: usize,
    /// Offset of the panel (columns x height) in the factor.
    pub(crate) panel: usize,
    /// Offset of the update matrix on its stack, after what stretches leave has moved together.
    pub(crate) update: usize,
    /// Offset on its stack of the inverse over the rows below: no two overlap that are of use at the same time, if fronts are
    /// visited one by one, parents first.
    pub(crate) corner: usize,
    /// Which of the two stacks holds the update: the parity of the depth.
    pub(crate) stack: usize,
    /// Range in [`Symbolic::children`].
    pub(crate) children: Range<usize>,
    /// Range in [`Symbolic::entries`] of the matrix's off-diagonal blocks.
    pub(crate) entries: Range<usize>,
}

/// Fronts that one thread factorises, and the memory that it writes, in blocks.
#[derive(Debug)]
pub(crate) struct Stretch {
    /// Children before parents.
    pub(crate) fronts: Vec<usize>,
    /// Range in the factor. That of the last stretch also covers fronts of other stretches in between.
    pub(crate) panels: Range<usize>,
    /// Range on each stack.
    pub(crate) stacks: [Range<usize>; 2],
    /// Where the updates that it leaves on each stack move, from the start of its range. The offsets of all its updates count from
    /// the start of this.
    pub(crate) left: [Range<usize>; 2],
}

impl Front {
    /// Rows below the eliminated columns.
    pub(crate) fn below(&self) -> usize {
        self.rows.len()
    }

    /// End of the panel in the factor.
    pub(super) fn panel_end(&self) -> usize {
        self.panel + self.columns * self.height()
    }

    /// Rows of the front.
    pub(crate) fn height(&self) -> usize {
        self.columns + self.rows.len()
    }
}

/// Position of an off-diagonal block of the matrix in a front's panel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Index of the block among the pairs.
    pub(crate) pair: usize,
    /// Block column in the panel.
    pub(crate) column: usize,
    /// Block row in the panel.
    pub(crate) row: usize,
    /// Whether the stored block is that of the upper triangle in elimination order.
    pub(crate) transposed: bool,
}

/// Operations of a partial dense Cholesky: `sum over columns of (rows at and below)^2`.
pub(super) fn front_flops(front: &Front, block: usize) -> f64 {
    let columns = (front.columns * block) as f64;
    let below = (front.below() * block) as f64;
    columns * below * below + columns * columns * below + columns.powi(3) / 3.0
}

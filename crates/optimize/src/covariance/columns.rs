//! Blocks of the covariance where the factor has none.

use rayon::prelude::*;

use super::part::{Block, Part, Place};

/// The blocks that come from columns of the inverse, one column for each first node.
pub(super) struct Columns<const DOF: usize> {
    /// Component, first and second node of each block; ascending.
    wanted: Vec<(usize, usize, usize)>,
    blocks: Vec<Block<DOF>>,
}

impl<const DOF: usize> Columns<DOF> {
    /// Computes the blocks of these places that are still missing.
    pub(super) fn of(
        parts: &[Part<DOF>],
        places: &[Option<Place>],
        blocks: &[Option<[Option<Block<DOF>>; 3]>],
    ) -> Self {
        let wanted = absent(places, blocks);
        let mut found = Vec::with_capacity(wanted.len());
        for of_part in wanted.chunk_by(|one, other| one.0 == other.0) {
            let part = &parts[of_part[0].0];
            let columns: Vec<_> = of_part.chunk_by(|one, other| one.1 == other.1).collect();
            let of_columns: Vec<_> = columns
                .par_iter()
                .map_init(
                    || part.factor.workspace(),
                    |workspace, column| {
                        let rows: Vec<usize> = column.iter().map(|&(_, _, node)| node - part.held).collect();
                        let first = column[0].1 - part.held;
                        part.factor.inverse_column(&part.symbolic, first, &rows, workspace)
                    },
                )
                .collect();
            found.extend(of_columns.into_iter().flatten().map(|block| block.transpose()));
        }
        Self { wanted, blocks: found }
    }

    pub(super) fn block(&self, part: usize, (row, column): (usize, usize)) -> Option<Block<DOF>> {
        Some(self.blocks[self.wanted.binary_search(&(part, row, column)).ok()?])
    }
}

/// The blocks, ascending, that neither a held node nor the inverse over the pattern gives.
fn absent<const DOF: usize>(
    places: &[Option<Place>],
    blocks: &[Option<[Option<Block<DOF>>; 3]>],
) -> Vec<(usize, usize, usize)> {
    let mut absent: Vec<_> = places
        .iter()
        .zip(blocks)
        .filter_map(|(place, blocks)| place.as_ref().zip(blocks.as_ref()))
        .flat_map(|(place, blocks)| {
            let wanted = place.blocks().into_iter().zip(blocks);
            wanted.filter(|(_, block)| block.is_none()).map(|((row, column), _)| (place.part, row, column))
        })
        .collect();
    absent.sort_unstable();
    absent.dedup();
    absent
}

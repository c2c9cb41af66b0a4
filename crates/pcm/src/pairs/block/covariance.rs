//! The covariance of the loops through a candidate and each lane of a register.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]
#![allow(
    clippy::needless_range_loop,
    reason = "formulas over rows, columns and terms of several matrices at once"
)]

use pulp::Simd;

use super::{Block, Row};
use posecut_geometry::lanes::{Lanes, Wide};

impl<const DOF: usize> Row<'_, DOF> {
    /// The covariance of a stretch is that of the later end minus that of the earlier end: 1 if the block's end is the
    /// later one, else -1.
    #[inline(always)]
    fn sign<S: Simd>(&self, simd: S, block: &Block<DOF>, first: usize, chain: usize) -> Lanes<S> {
        let one = Lanes::splat(simd, 1.0);
        let there = Lanes::load(simd, &block.places[chain], first);
        there.less_than(Lanes::splat(simd, self.places[chain])).select(-one, one)
    }

    /// The lower triangle of C_a + C_b + Ad(T_a^-1) dS_A Ad(T_a^-1)^T + dS_B, for stretches that share no step.
    #[inline(always)]
    pub(super) fn covariance<S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        sum: &mut [[Lanes<S>; DOF]; DOF],
    ) {
        let load = |wide: &Wide| Lanes::load(simd, wide, first);
        let splat = |value: f64| Lanes::splat(simd, value);
        let (sign_a, sign_b) = (self.sign(simd, block, first, 0), self.sign(simd, block, first, 1));
        // Translations come first: 2 of 3 axes, or 3 of 6. An adjoint is zero below them. Sums are kept in registers.
        let translations = DOF.div_ceil(2);
        let mut carried = [[sign_a; DOF]; DOF];
        for (column, carried) in carried.iter_mut().enumerate() {
            let mut stretch = [sign_a; DOF];
            for (row, stretch) in stretch.iter_mut().enumerate() {
                let (row, column) = (row.max(column), row.min(column));
                *stretch = (load(&block.chain_a[row][column]) - splat(self.chain_a[(row, column)])) * sign_a;
            }
            for (row, carried) in carried.iter_mut().enumerate() {
                let mut entry = stretch[translations] * self.frame[(row, translations)];
                for term in translations + 1..DOF {
                    entry = entry + stretch[term] * self.frame[(row, term)];
                }
                if row < translations {
                    for term in 0..translations {
                        entry = entry + stretch[term] * self.frame[(row, term)];
                    }
                }
                *carried = entry;
            }
        }
        for (row, sum) in sum.iter_mut().enumerate() {
            for (column, sum) in sum.iter_mut().enumerate().take(row + 1) {
                let stretch =
                    (load(&block.chain_b[row][column]) - splat(self.chain_b[(row, column)])) * sign_b;
                let own = load(&block.landmark[row][column]) + splat(self.landmark[(row, column)]);
                let mut entry = own + stretch;
                for term in translations..DOF {
                    entry = entry + carried[term][row] * self.frame[(column, term)];
                }
                if column < translations {
                    for term in 0..translations {
                        entry = entry + carried[term][row] * self.frame[(column, term)];
                    }
                }
                *sum = entry;
            }
        }
    }
}

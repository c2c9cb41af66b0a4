//! Steps that both stretches of a loop contain.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]
#![allow(
    clippy::needless_range_loop,
    reason = "formulas over rows, columns and terms of several matrices at once"
)]

use pulp::Simd;

use super::{Block, Row};
use posecut_geometry::lanes::{Lanes, Wide};

impl<const DOF: usize> Row<'_, DOF> {
    /// Adds the effect of steps that both stretches share. A shared step acts through T + I if both stretches run the same
    /// way, and through T - I if they do not, where T = Ad(T_a^-1). With S the covariance of the shared steps,
    ///
    /// (T +- I) S (T +- I)^T - T S T^T - S = +- (T S + S T^T).
    #[inline(always)]
    pub(super) fn add_shared<S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        asked: u64,
        sum: &mut [[Lanes<S>; DOF]; DOF],
    ) {
        let load = |wide: &Wide| Lanes::load(simd, wide, first);
        let splat = |value: f64| Lanes::splat(simd, value);
        let (zero, one) = (splat(0.0), splat(1.0));
        let (here_i, here_k) = (splat(self.places[0]), splat(self.places[1]));
        let (there_i, there_k) = (load(&block.places[0]), load(&block.places[1]));
        // The ends of both stretches in the order of the chain, and the steps from the later start to the earlier end.
        let (back_i, back_k) = (there_i.less_than(here_i), there_k.less_than(here_k));
        let (start_i, end_i) = (back_i.select(there_i, here_i), back_i.select(here_i, there_i));
        let (start_k, end_k) = (back_k.select(there_k, here_k), back_k.select(here_k, there_k));
        let (starts_with_k, ends_with_i) = (start_i.less_than(start_k), end_i.less_than(end_k));
        let start = starts_with_k.select(start_k, start_i);
        let shared = start.less_than(ends_with_i.select(end_i, end_k));
        if shared.bits() & asked == 0 {
            return;
        }
        // The first stretch runs from i to j, the second from l back to k.
        let same_way = here_i.less_than(there_i).select(back_k.select(one, -one), back_k.select(-one, one));
        let sign = shared.select(same_way, zero);
        let mut steps = [[zero; DOF]; DOF];
        for row in 0..DOF {
            for column in 0..=row {
                let (own_i, own_k) = (splat(self.chain_a[(row, column)]), splat(self.chain_b[(row, column)]));
                let (other_i, other_k) =
                    (load(&block.chain_a[row][column]), load(&block.chain_b[row][column]));
                let at_start =
                    starts_with_k.select(back_k.select(other_k, own_k), back_i.select(other_i, own_i));
                let at_end = ends_with_i.select(back_i.select(own_i, other_i), back_k.select(own_k, other_k));
                let entry = (at_end - at_start) * sign;
                steps[row][column] = entry;
                steps[column][row] = entry;
            }
        }
        let translations = DOF.div_ceil(2);
        for row in 0..DOF {
            for column in 0..DOF {
                // An entry of T S; an adjoint is zero below its translations.
                let mut entry = steps[translations][column] * self.frame[(row, translations)];
                for term in translations + 1..DOF {
                    entry = entry + steps[term][column] * self.frame[(row, term)];
                }
                if row < translations {
                    for term in 0..translations {
                        entry = entry + steps[term][column] * self.frame[(row, term)];
                    }
                }
                let (low, high) = (row.max(column), row.min(column));
                let twice = if row == column { entry + entry } else { entry };
                sum[low][high] = sum[low][high] + twice;
            }
        }
    }
}

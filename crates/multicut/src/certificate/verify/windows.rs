//! Windows in a certificate: graphs that share the capacity which conflicts leave.

use std::io::BufRead;

use super::VerifyError;
use super::part::{Part, ROUNDING};
use super::proof::Checker;

impl<B: BufRead> Checker<B> {
    /// Checks a proof by windows that starts at the current line `windows`; returns its bound and leaves the reader on the
    /// line after it.
    ///
    /// Any multicut costs at least the bound of the conflicts plus `sum r_e p_e`, where `r` is the capacity that they leave and
    /// `p` the payments. Each window takes capacities `s <= r` for itself. The payments in a window cost its bound minus the sum
    /// of its negative costs at least.
    pub(super) fn windows(&mut self, kernel: &Part, depth: usize) -> Result<f64, VerifyError> {
        let (conflicts, windows): (usize, usize) = (self.number(1)?, self.number(2)?);
        self.next()?;
        let (mut left, mut bound) = self.packing(kernel, conflicts)?;
        for _ in 0..windows {
            let nodes = self.numbers("window")?;
            kernel.has(&nodes).map_err(|reason| self.refute(reason))?;
            self.next()?;
            if self.words.first().is_none_or(|word| word != "edges") {
                return Err(self.refute("expected `edges`".into()));
            }
            let mut window = Part::new(nodes.len());
            for at in (1..self.words.len()).step_by(3) {
                let (tail, head): (u32, u32) = (self.number(at)?, self.number(at + 1)?);
                let taken: f64 = self.number(at + 2)?;
                self.take_capacity(kernel, &nodes, (tail, head, taken), &mut left)?;
                if window.cost(tail, head) != 0.0 {
                    return Err(self.refute(format!("edge {tail} {head} appears twice")));
                }
                window.add(tail, head, taken);
            }
            let free = window.negative_sum();
            self.next()?;
            bound += self.reduced(window, depth + 1)? - free;
        }
        Ok(bound)
    }

    /// Subtracts what a window takes of an edge's capacity, if it is left and has the edge's sign.
    fn take_capacity(
        &self,
        kernel: &Part,
        nodes: &[u32],
        (tail, head, taken): (u32, u32, f64),
        left: &mut Part,
    ) -> Result<(), VerifyError> {
        let (Some(&from), Some(&to)) = (nodes.get(tail as usize), nodes.get(head as usize)) else {
            return Err(self.refute(format!("the window has no edge {tail} {head}")));
        };
        let cost = kernel.cost(from, to);
        let key = (from.min(to), from.max(to));
        let capacity = left.arcs.get_mut(key.0 as usize).and_then(|arcs| arcs.get_mut(&key.1));
        let Some(capacity) = capacity else {
            return Err(self.refute(format!("there is no edge {from} {to}")));
        };
        *capacity -= taken.abs();
        // A sum with a number that is none is none, and fails here.
        if !(*capacity >= -ROUNDING * cost.abs() && taken * cost > 0.0) {
            return Err(
                self.refute(format!("a window takes {taken} of edge {from} {to}, which costs {cost}"))
            );
        }
        *capacity = capacity.max(0.0);
        Ok(())
    }
}

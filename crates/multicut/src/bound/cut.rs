//! Inequalities of the branch-and-cut tree, which hold for every multicut.

use super::conflict::Conflict;
use crate::graph::kernel::Kernel;

/// An inequality in the payments of edges.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Cut {
    /// Edges with the signs that the conflict asks for.
    Conflict(Conflict),
    /// A cycle with edges of any sign: the edge from the last node to the first is cut only if another edge is (Chopra, Rao
    /// 1993). Needed only below branchings that cut an attractive edge or join the ends of a repulsive one.
    Cycle(Vec<u32>),
}

impl Cut {
    /// Edges with coefficients, and the least value of their sum. With `y_e` for cut edges, a cycle closed by `f` states
    /// `sum y_e - y_f >= 0`, where `y_e` is the payment of an attractive edge, and 1 minus the payment of a repulsive one.
    pub(crate) fn row(&self, kernel: &Kernel) -> (Vec<(u32, f64)>, f64) {
        match self {
            Self::Conflict(conflict) => {
                let uses = conflict.uses(kernel).into_iter();
                (uses.map(|(edge, times)| (edge, f64::from(times))).collect(), conflict.least())
            }
            Self::Cycle(nodes) => {
                let edges = kernel.cycle_edges(nodes);
                let mut least = 0.0;
                let row = edges.iter().enumerate().map(|(place, &edge)| {
                    let side = if place + 1 == edges.len() { -1.0 } else { 1.0 };
                    if kernel.costs[edge as usize] > 0.0 {
                        (edge, side)
                    } else {
                        least -= side;
                        (edge, -side)
                    }
                });
                (row.collect(), least)
            }
        }
    }
}

//! Trees of cases in a certificate: inequalities, weights and the bounds that they prove.

use std::collections::BTreeMap;
use std::io::BufRead;

use super::VerifyError;
use super::part::Part;
use super::proof::Checker;

/// An edge by its ends, the smaller first.
type Pair = (u32, u32);

/// Coefficients of the payments of edges, and the least value of the sum.
struct Inequality {
    entries: Vec<(Pair, f64)>,
    least: f64,
}

fn pair(tail: u32, head: u32) -> Pair {
    (tail.min(head), tail.max(head))
}

impl<B: BufRead> Checker<B> {
    /// Checks a tree of cases that starts at the current line `tree`; returns its bound and leaves the reader on the line
    /// after it. `round` rounds a bound up if all costs are integers.
    pub(super) fn tree(&mut self, kernel: &Part, round: &dyn Fn(f64) -> f64) -> Result<f64, VerifyError> {
        let (count, cases): (usize, usize) = (self.number(1)?, self.number(2)?);
        self.next()?;
        let mut inequalities = Vec::new();
        for _ in 0..count {
            inequalities.push(self.inequality(kernel)?);
            self.next()?;
        }
        let mut bound = f64::INFINITY;
        // What the cases yet to come fix; a case's second half waits while its first is read.
        let mut open: Vec<BTreeMap<Pair, bool>> = vec![BTreeMap::new()];
        for _ in 0..cases {
            let Some(mut fixed) = open.pop() else {
                return Err(self.refute("there are more cases than the tree has".into()));
            };
            match self.words.first().map(String::as_str) {
                Some("leaf") => {
                    let weights = self.weights(1, inequalities.len())?;
                    bound = bound.min(round(prove(kernel, &inequalities, &weights, &fixed).0));
                }
                Some("split") => {
                    let edge = self.edge(kernel, 1)?;
                    for paid in [true, false] {
                        let mut case = fixed.clone();
                        case.insert(edge, paid);
                        open.push(case);
                    }
                }
                Some("fixed") => {
                    let edges: usize = self.number(1)?;
                    let weights = self.weights(2, inequalities.len())?;
                    let (proved, reduced) = prove(kernel, &inequalities, &weights, &fixed);
                    let mut fresh = Vec::new();
                    for _ in 0..edges {
                        self.next()?;
                        let edge = self.edge(kernel, 0)?;
                        let paid = match self.number(2)? {
                            0u8 => false,
                            1 => true,
                            _ => return Err(self.refute("a payment is 0 or 1".into())),
                        };
                        if fixed.contains_key(&edge) {
                            return Err(self.refute(format!("edge {} {} is fixed already", edge.0, edge.1)));
                        }
                        // The proved bound has the least of 0 and the reduced cost; the other payment costs more.
                        let cost = reduced.get(&edge).copied().unwrap_or(0.0);
                        let other = if paid { 0.0 } else { cost };
                        bound = bound.min(round(proved - cost.min(0.0) + other));
                        fresh.push((edge, paid));
                    }
                    fixed.extend(fresh);
                    open.push(fixed);
                }
                _ => return Err(self.refute("expected `leaf`, `split` or `fixed`".into())),
            }
            self.next()?;
        }
        if open.is_empty() {
            Ok(bound)
        } else {
            Err(self.refute("the tree has more cases than it states".into()))
        }
    }

    /// The edge whose ends stand at a position.
    fn edge(&self, kernel: &Part, place: usize) -> Result<Pair, VerifyError> {
        let (tail, head): (u32, u32) = (self.number(place)?, self.number(place + 1)?);
        if kernel.cost(tail, head) == 0.0 {
            return Err(self.refute(format!("there is no edge {tail} {head}")));
        }
        Ok(pair(tail, head))
    }

    /// Pairs of an inequality's number and its weight, from a position on.
    fn weights(&self, start: usize, count: usize) -> Result<Vec<(usize, f64)>, VerifyError> {
        let mut weights = Vec::new();
        for place in (start..self.words.len()).step_by(2) {
            let (number, weight): (usize, f64) = (self.number(place)?, self.number(place + 1)?);
            if number >= count {
                return Err(self.refute(format!("there is no inequality {number}")));
            }
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(self.refute("a weight must be a positive number".into()));
            }
            weights.push((number, weight));
        }
        Ok(weights)
    }

    /// The inequality on the current line.
    fn inequality(&self, kernel: &Part) -> Result<Inequality, VerifyError> {
        if self.words.first().is_some_and(|word| word == "any") {
            return self.any_cycle(kernel);
        }
        let (_, uses, least) = self.conflict(kernel)?;
        let mut entries: BTreeMap<Pair, f64> = BTreeMap::new();
        for (tail, head) in uses {
            if kernel.cost(tail, head) == 0.0 {
                return Err(self.refute(format!("there is no edge {tail} {head}")));
            }
            *entries.entry(pair(tail, head)).or_insert(0.0) += 1.0;
        }
        Ok(Inequality { entries: entries.into_iter().collect(), least })
    }

    /// A simple cycle of edges of any sign: the last one is cut only if another one is.
    fn any_cycle(&self, kernel: &Part) -> Result<Inequality, VerifyError> {
        let nodes = self.nodes(2..self.words.len())?;
        let mut sorted = nodes.clone();
        sorted.sort_unstable();
        sorted.dedup();
        if nodes.len() < 3 || sorted.len() < nodes.len() {
            return Err(self.refute("a cycle needs three different nodes".into()));
        }
        let (mut entries, mut least) = (Vec::new(), 0.0);
        for (place, &tail) in nodes.iter().enumerate() {
            let last = place + 1 == nodes.len();
            let head = nodes[if last { 0 } else { place + 1 }];
            let cost = kernel.cost(tail, head);
            if cost == 0.0 {
                return Err(self.refute(format!("there is no edge {tail} {head}")));
            }
            // A cut is the payment of an attractive edge, and 1 minus that of a repulsive one.
            let cut = if last { -1.0 } else { 1.0 };
            if cost < 0.0 {
                least -= cut;
            }
            entries.push((pair(tail, head), if cost > 0.0 { cut } else { -cut }));
        }
        Ok(Inequality { entries, least })
    }
}

/// The bound that weights prove in a case, and the reduced costs of edges: the negative costs, plus weight times least value of
/// each inequality, plus for each edge the least product of its reduced cost and a payment that the case allows.
fn prove(
    kernel: &Part,
    inequalities: &[Inequality],
    weights: &[(usize, f64)],
    fixed: &BTreeMap<Pair, bool>,
) -> (f64, BTreeMap<Pair, f64>) {
    let mut reduced: BTreeMap<Pair, f64> = BTreeMap::new();
    for (tail, arcs) in kernel.arcs.iter().enumerate() {
        for (&head, cost) in arcs.range(tail as u32 + 1..) {
            reduced.insert((tail as u32, head), cost.abs());
        }
    }
    let mut bound = kernel.negative_sum();
    for &(number, weight) in weights {
        let Inequality { entries, least } = &inequalities[number];
        bound += weight * least;
        for (edge, coefficient) in entries {
            if let Some(reduced) = reduced.get_mut(edge) {
                *reduced -= weight * coefficient;
            }
        }
    }
    for (edge, reduced) in &reduced {
        bound += match fixed.get(edge) {
            None => reduced.min(0.0),
            Some(true) => *reduced,
            Some(false) => 0.0,
        };
    }
    (bound, reduced)
}

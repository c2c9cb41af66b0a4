//! Packings in a certificate: signs, shape and capacity of every conflict.

use std::io::BufRead;

use super::VerifyError;
use super::part::{Part, ROUNDING};
use super::proof::Checker;

/// A conflict's weight, its edges, each as often as it counts, and the least payment.
pub(super) type Weighted = (f64, Vec<(u32, u32)>, f64);

impl<B: BufRead> Checker<B> {
    /// Checks packed conflicts. Returns residual capacities and bound; leaves the reader on the line after the conflicts.
    pub(crate) fn packing(&mut self, kernel: &Part, conflicts: usize) -> Result<(Part, f64), VerifyError> {
        let mut residual = kernel.clone();
        for arcs in &mut residual.arcs {
            for cost in arcs.values_mut() {
                *cost = cost.abs();
            }
        }
        let mut bound = kernel.negative_sum();
        for _ in 0..conflicts {
            let (weight, uses, least) = self.conflict(kernel)?;
            for (tail, head) in uses {
                let cost = kernel.cost(tail, head).abs();
                let key = (tail.min(head), tail.max(head));
                let left = residual.arcs.get_mut(key.0 as usize).and_then(|arcs| arcs.get_mut(&key.1));
                let Some(left) = left else {
                    return Err(self.refute(format!("there is no edge {tail} {head}")));
                };
                *left -= weight;
                if *left < -ROUNDING * cost {
                    return Err(self
                        .refute(format!("the weights on edge {tail} {head} add up to more than its cost")));
                }
                *left = left.max(0.0);
            }
            bound += least * weight;
            self.next()?;
        }
        Ok((residual, bound))
    }

    /// The conflict on the current line.
    pub(super) fn conflict(&self, kernel: &Part) -> Result<Weighted, VerifyError> {
        let word = self.words.first().map_or("", String::as_str);
        let weight: f64 = self.number(usize::from(["wheel", "parts"].contains(&word)))?;
        if !(weight >= 0.0 && weight.is_finite()) {
            return Err(self.refute("a weight must be a positive number".into()));
        }
        let (uses, least) = match word {
            "wheel" => self.wheel(kernel)?,
            "parts" => self.parts(kernel)?,
            _ => self.cycle(kernel)?,
        };
        Ok((weight, uses, least))
    }

    /// The edges among and between two sets of nodes: all must exist, attract between the sets, and repel inside.
    fn parts(&self, kernel: &Part) -> Result<(Vec<(u32, u32)>, f64), VerifyError> {
        let slash = self.words.iter().position(|word| word == "/").unwrap_or(self.words.len());
        let few = self.nodes(2..slash)?;
        let many = self.nodes((slash + 1).min(self.words.len())..self.words.len())?;
        let nodes: Vec<u32> = few.iter().chain(&many).copied().collect();
        if few.is_empty() || few.len() > many.len() {
            return Err(self.refute("two sets are needed, the smaller one first".into()));
        }
        let mut uses = Vec::new();
        for (place, &tail) in nodes.iter().enumerate() {
            for (other, &head) in nodes.iter().enumerate().skip(place + 1) {
                let between = (place < few.len()) != (other < few.len());
                let cost = kernel.cost(tail, head);
                if tail == head || (if between { cost <= 0.0 } else { cost >= 0.0 }) {
                    return Err(self.wrong_sign(tail, head));
                }
                uses.push((tail, head));
            }
        }
        Ok((uses, (few.len() * (many.len() - 1)) as f64))
    }

    /// The edges of a cycle; all but the last must be attractive.
    fn cycle(&self, kernel: &Part) -> Result<(Vec<(u32, u32)>, f64), VerifyError> {
        let nodes = self.nodes(1..self.words.len())?;
        if nodes.len() < 3 {
            return Err(self.refute("a cycle needs a weight and three nodes".into()));
        }
        let mut uses = self.attractive(kernel, &nodes)?;
        let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
        if kernel.cost(last, first) >= 0.0 {
            return Err(self.wrong_sign(last, first));
        }
        uses.push((last, first));
        Ok((uses, 1.0))
    }

    /// The edges of a wheel, each as often as it occurs: a rim with an odd number of repulsive edges, and for each of these
    /// an attractive path from one centre to the node where the rim enters it.
    fn wheel(&self, kernel: &Part) -> Result<(Vec<(u32, u32)>, f64), VerifyError> {
        let mut ends: Vec<usize> = (2..self.words.len()).filter(|&place| self.words[place] == "/").collect();
        ends.push(self.words.len());
        let rim = self.nodes(2..ends[0])?;
        let mut spokes = ends.windows(2).map(|pair| self.nodes(pair[0] + 1..pair[1]));
        let mut uses = Vec::new();
        let (mut centre, mut repulsive) = (None, 0u32);
        for (&tail, &head) in rim.iter().zip(rim.iter().skip(1).chain(rim.first())) {
            let cost = kernel.cost(tail, head);
            uses.push((tail, head));
            if cost > 0.0 {
                continue;
            }
            if cost == 0.0 {
                return Err(self.refute(format!("there is no edge {tail} {head}")));
            }
            repulsive += 1;
            let spoke = spokes.next().unwrap_or_else(|| Err(self.refute("a spoke is missing".into())))?;
            let from = *centre.get_or_insert(spoke.first().copied());
            if from.is_none() || spoke.first().copied() != from || spoke.last() != Some(&tail) {
                return Err(self.refute(format!("the spoke to {tail} does not join the centre to it")));
            }
            uses.extend(self.attractive(kernel, &spoke)?);
        }
        if repulsive % 2 == 0 || spokes.next().is_some() {
            return Err(
                self.refute("a wheel needs an odd number of repulsive edges, and a spoke for each".into())
            );
        }
        Ok((uses, f64::from(repulsive.div_ceil(2))))
    }

    pub(super) fn nodes(&self, mut places: std::ops::Range<usize>) -> Result<Vec<u32>, VerifyError> {
        places.try_fold(Vec::new(), |mut nodes, place| {
            nodes.push(self.number(place)?);
            Ok(nodes)
        })
    }

    /// The edges of a path, if all are attractive.
    fn attractive(&self, kernel: &Part, path: &[u32]) -> Result<Vec<(u32, u32)>, VerifyError> {
        let edges: Vec<(u32, u32)> = path.windows(2).map(|pair| (pair[0], pair[1])).collect();
        match edges.iter().find(|&&(tail, head)| kernel.cost(tail, head) <= 0.0) {
            Some(&(tail, head)) => Err(self.wrong_sign(tail, head)),
            None => Ok(edges),
        }
    }

    fn wrong_sign(&self, tail: u32, head: u32) -> VerifyError {
        self.refute(format!("edge {tail} {head} has the wrong sign"))
    }
}

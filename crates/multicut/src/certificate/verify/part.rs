//! The verifier's own graph, on which it checks and repeats the reductions.

use std::collections::{BTreeMap, BTreeSet};

/// Share of the costs involved by which a condition may fail because of rounding.
pub(crate) const ROUNDING: f64 = 1e-12;

/// A graph as ordered maps, with the certificate's numbers of nodes.
#[derive(Clone)]
pub(crate) struct Part {
    pub(crate) arcs: Vec<BTreeMap<u32, f64>>,
    /// The cost of edges that left the graph.
    pub(crate) constant: f64,
}

impl Part {
    pub(crate) fn new(nodes: usize) -> Self {
        Self { arcs: vec![BTreeMap::new(); nodes], constant: 0.0 }
    }

    pub(crate) fn add(&mut self, tail: u32, head: u32, cost: f64) {
        for (a, b) in [(tail, head), (head, tail)] {
            let sum = self.arcs[a as usize].entry(b).or_insert(0.0);
            *sum += cost;
            if *sum == 0.0 {
                self.arcs[a as usize].remove(&b);
            }
        }
    }

    fn remove(&mut self, tail: u32, head: u32) -> Option<f64> {
        self.arcs[head as usize].remove(&tail);
        self.arcs[tail as usize].remove(&head)
    }

    pub(crate) fn cost(&self, tail: u32, head: u32) -> f64 {
        self.arcs.get(tail as usize).and_then(|arcs| arcs.get(&head)).copied().unwrap_or(0.0)
    }

    /// Sum of the absolute costs at a node.
    fn magnitude(&self, node: u32) -> f64 {
        self.arcs[node as usize].values().map(|cost| cost.abs()).sum()
    }

    pub(crate) fn has(&self, nodes: &[u32]) -> Result<(), String> {
        match nodes.iter().find(|&&node| node as usize >= self.arcs.len()) {
            Some(node) => Err(format!("there is no node {node}")),
            None => Ok(()),
        }
    }

    /// Moves the edges among `nodes` to a separate graph, where nodes are numbered by their positions in `nodes`.
    pub(crate) fn take(&mut self, nodes: &[u32]) -> Result<Self, String> {
        self.has(nodes)?;
        let places: BTreeMap<u32, u32> =
            nodes.iter().enumerate().map(|(place, &node)| (node, place as u32)).collect();
        if places.len() != nodes.len() {
            return Err("a node appears twice".into());
        }
        let mut part = Self::new(nodes.len());
        for (place, &node) in nodes.iter().enumerate() {
            let inside: Vec<(u32, u32)> = self.arcs[node as usize]
                .keys()
                .filter_map(|other| places.get(other).map(|&to| (*other, to)))
                .collect();
            for (other, to) in inside {
                if let Some(cost) = self.remove(node, other) {
                    part.add(place as u32, to, cost);
                }
            }
        }
        Ok(part)
    }

    /// Moves the edges among `nodes` to a separate graph, where nodes keep their numbers.
    pub(crate) fn split(&mut self, nodes: &[u32]) -> Result<Self, String> {
        let part = self.take(nodes)?;
        let mut named = Self::new(self.arcs.len());
        for (tail, arcs) in part.arcs.iter().enumerate() {
            for (&head, &cost) in arcs {
                if (tail as u32) < head {
                    named.add(nodes[tail], nodes[head as usize], cost);
                }
            }
        }
        Ok(named)
    }

    pub(crate) fn negative_sum(&self) -> f64 {
        let arcs = self.arcs.iter().enumerate();
        arcs.flat_map(|(tail, arcs)| arcs.range(tail as u32 + 1..)).map(|arc| arc.1.min(0.0)).sum()
    }

    pub(crate) fn is_integral(&self) -> bool {
        self.arcs.iter().flat_map(BTreeMap::values).all(|cost| cost.fract() == 0.0)
    }

    pub(crate) fn isolate(&mut self, node: u32) -> Result<(), String> {
        self.has(&[node])?;
        let arcs = self.arcs[node as usize].clone();
        if arcs.values().any(|cost| *cost > 0.0) {
            return Err(format!("node {node} has an attractive edge"));
        }
        for (other, cost) in arcs {
            self.constant += cost;
            self.remove(node, other);
        }
        Ok(())
    }

    pub(crate) fn eliminate(&mut self, node: u32) -> Result<(), String> {
        self.has(&[node])?;
        let arcs: Vec<(u32, f64)> = self.arcs[node as usize].iter().map(|(&x, &c)| (x, c)).collect();
        let [(x, a), (y, b)] = arcs[..] else {
            return Err(format!("node {node} has {} edges instead of two", arcs.len()));
        };
        let (joined, apart) = ((a + b).min(0.0), a.min(b).min(a + b));
        self.remove(node, x);
        self.remove(node, y);
        self.constant += joined;
        self.add(x, y, apart - joined);
        Ok(())
    }

    fn contract(&mut self, kept: u32, gone: u32) {
        self.remove(kept, gone);
        let arcs = std::mem::take(&mut self.arcs[gone as usize]);
        for (other, cost) in arcs {
            self.arcs[other as usize].remove(&gone);
            self.add(kept, other, cost);
        }
    }

    pub(crate) fn dominance(&mut self, kept: u32, gone: u32) -> Result<(), String> {
        self.has(&[kept, gone])?;
        let cost = self.cost(kept, gone);
        let total = self.magnitude(kept).min(self.magnitude(gone));
        if !(cost > 0.0 && 2.0 * cost >= total * (1.0 - ROUNDING)) {
            return Err(format!("edge {kept} {gone} costs {cost}, less than half of {total}"));
        }
        self.contract(kept, gone);
        Ok(())
    }

    /// Contracts by the rule of pairs with these shares, which need not add up to 1.
    pub(crate) fn pair(&mut self, u: u32, v: u32, [to_u, to_v, out]: [f64; 3]) -> Result<(), String> {
        self.has(&[u, v])?;
        let shares = to_u + to_v + out;
        if !(to_u >= 0.0 && to_v >= 0.0 && out >= 0.0 && shares.is_finite() && shares > 0.0) {
            return Err("shares of moves must be numbers of 0 or more, not all of them 0".into());
        }
        let others = self.arcs[u as usize].keys().chain(self.arcs[v as usize].keys());
        let others: BTreeSet<u32> = others.copied().filter(|&node| node != u && node != v).collect();
        let loss: f64 = others
            .into_iter()
            .map(|node| {
                let (at_u, at_v) = (self.cost(u, node), self.cost(v, node));
                0f64.max((to_v + out) * at_u - to_u * at_v).max((to_u + out) * at_v - to_v * at_u)
            })
            .sum();
        let gain = shares * self.cost(u, v);
        let slack = ROUNDING * shares * (self.magnitude(u) + self.magnitude(v));
        if !(gain > 0.0 && gain >= loss - slack) {
            return Err(format!("joining {u} and {v} gains {gain} on average, but may lose {loss}"));
        }
        self.contract(u, v);
        Ok(())
    }

    pub(crate) fn triangle(&mut self, u: u32, v: u32, w: u32) -> Result<(), String> {
        self.has(&[u, v, w])?;
        let (uv, uw, vw) = (self.cost(u, v), self.cost(u, w), self.cost(v, w));
        let (at_u, at_v) = (self.magnitude(u), self.magnitude(v));
        let (rest_u, rest_v) = (at_u - uv - uw, at_v - uv - vw);
        let slack = ROUNDING * (at_u + at_v);
        let least = |gain: f64, loss: f64| gain >= loss - slack;
        let holds = uv > 0.0
            && uw > 0.0
            && vw > 0.0
            && least(uv + uw, rest_u)
            && least(uv + vw, rest_v)
            && (least(uv, rest_u) || least(uv, rest_v) || least(uv + uw + vw, rest_u + rest_v));
        if !holds {
            return Err(format!("the triangle {u} {v} {w} does not dominate"));
        }
        self.contract(u, v);
        Ok(())
    }
}

//! An independent check of certificates: shares no algorithm with the solver.

use std::collections::BTreeMap;
use std::io::BufRead;

use crate::graph::Graph;
use crate::proof::MAGIC;

/// What a certificate proves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verified {
    /// Objective of the labels in the certificate.
    pub objective: f64,
    /// No multicut of the graph costs less.
    pub lower_bound: f64,
    /// Whether both agree: exactly for integer costs, else up to 10^-9 of the sum of absolute costs.
    pub optimal: bool,
}

/// Why a certificate proves nothing.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// The file could not be read.
    #[error("the certificate could not be read after line {line}: {source}")]
    Read {
        /// Lines read before.
        line: usize,
        /// What the system says.
        source: std::io::Error,
    },
    /// The first line is not that of a certificate.
    #[error("line 1 is not {MAGIC:?}; is this a certificate?")]
    Header,
    /// A statement is malformed or does not hold.
    #[error("line {line} of the certificate does not hold: {reason}")]
    Refuted {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
}

/// Share of the costs involved by which a condition may fail for rounding.
const ROUNDING: f64 = 1e-12;

/// Proofs nested deeper than this are refused, for the sake of the stack.
const DEPTH: usize = 2_000;

/// Checks a certificate against a graph, in one pass over the file: each reduction's condition when it is made, each cycle's
/// signs and capacities, and that the parts of the graph share no edge. `O(log n)` for each edge touched.
pub fn verify(graph: &Graph, certificate: impl BufRead) -> Result<Verified, VerifyError> {
    let mut checker = Checker { lines: certificate.lines(), line: 0, words: Vec::new() };
    match checker.next() {
        Ok(()) if checker.words.join(" ") == MAGIC => {}
        Err(error @ VerifyError::Read { .. }) => return Err(error),
        _ => return Err(VerifyError::Header),
    }
    checker.next()?;
    let labels: Vec<u32> = checker.numbers("labels")?;
    let objective = graph.objective(&labels).map_err(|error| checker.refute(error.to_string()))?;
    let mut whole = Part::new(graph.node_count());
    let mut edges: Vec<(u32, u32, f64)> = graph
        .edges()
        .iter()
        .map(|edge| (edge.tail.min(edge.head), edge.tail.max(edge.head), edge.cost))
        .collect();
    edges.sort_unstable_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
    for (tail, head, cost) in edges {
        whole.add(tail, head, cost);
    }
    let magnitude: f64 = graph.edges().iter().map(|edge| edge.cost.abs()).sum();
    let mut bound = 0.0;
    checker.next()?;
    while checker.words.first().is_some_and(|word| word == "component") {
        let nodes = checker.numbers("component")?;
        let part = whole.take(&nodes).map_err(|reason| checker.refute(reason))?;
        checker.next()?;
        bound += checker.reduced(part, 0)?;
    }
    if checker.words != ["end"] {
        return Err(checker.refute("expected `component` or `end`".into()));
    }
    bound += whole.negative_sum();
    let integral = graph.edges().iter().all(|edge| edge.cost.fract() == 0.0);
    let tolerance = if integral { 0.5 } else { 1e-9 * magnitude };
    Ok(Verified { objective, lower_bound: bound, optimal: bound >= objective - tolerance })
}

/// A graph as ordered maps, nodes numbered as the certificate numbers them.
#[derive(Clone)]
struct Part {
    arcs: Vec<BTreeMap<u32, f64>>,
    /// What left the graph.
    constant: f64,
}

impl Part {
    fn new(nodes: usize) -> Self {
        Self { arcs: vec![BTreeMap::new(); nodes], constant: 0.0 }
    }

    fn add(&mut self, tail: u32, head: u32, cost: f64) {
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

    fn cost(&self, tail: u32, head: u32) -> f64 {
        self.arcs.get(tail as usize).and_then(|arcs| arcs.get(&head)).copied().unwrap_or(0.0)
    }

    /// Sum of the absolute costs at a node.
    fn magnitude(&self, node: u32) -> f64 {
        self.arcs[node as usize].values().map(|cost| cost.abs()).sum()
    }

    fn has(&self, nodes: &[u32]) -> Result<(), String> {
        match nodes.iter().find(|&&node| node as usize >= self.arcs.len()) {
            Some(node) => Err(format!("there is no node {node}")),
            None => Ok(()),
        }
    }

    /// Moves the edges among `nodes` to a part of their own, where nodes bear their positions.
    fn take(&mut self, nodes: &[u32]) -> Result<Self, String> {
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

    /// Moves the edges among `nodes` to a graph of their own, where nodes keep their names.
    fn split(&mut self, nodes: &[u32]) -> Result<Self, String> {
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

    fn negative_sum(&self) -> f64 {
        let arcs = self.arcs.iter().enumerate();
        arcs.flat_map(|(tail, arcs)| arcs.range(tail as u32 + 1..)).map(|arc| arc.1.min(0.0)).sum()
    }

    fn is_integral(&self) -> bool {
        self.arcs.iter().flat_map(BTreeMap::values).all(|cost| cost.fract() == 0.0)
    }

    fn isolate(&mut self, node: u32) -> Result<(), String> {
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

    fn eliminate(&mut self, node: u32) -> Result<(), String> {
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

    fn dominance(&mut self, kept: u32, gone: u32) -> Result<(), String> {
        self.has(&[kept, gone])?;
        let cost = self.cost(kept, gone);
        let total = self.magnitude(kept).min(self.magnitude(gone));
        if !(cost > 0.0 && 2.0 * cost >= total * (1.0 - ROUNDING)) {
            return Err(format!("edge {kept} {gone} costs {cost}, less than half of {total}"));
        }
        self.contract(kept, gone);
        Ok(())
    }

    fn triangle(&mut self, u: u32, v: u32, w: u32) -> Result<(), String> {
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

struct Checker<B> {
    lines: std::io::Lines<B>,
    line: usize,
    words: Vec<String>,
}

impl<B: BufRead> Checker<B> {
    fn refute(&self, reason: String) -> VerifyError {
        VerifyError::Refuted { line: self.line, reason }
    }

    fn next(&mut self) -> Result<(), VerifyError> {
        self.line += 1;
        match self.lines.next() {
            None => Err(self.refute("the file ends too early".into())),
            Some(Err(source)) => Err(VerifyError::Read { line: self.line - 1, source }),
            Some(Ok(line)) => {
                self.words = line.split_ascii_whitespace().map(String::from).collect();
                Ok(())
            }
        }
    }

    /// The word at a position as a number.
    fn number<T: std::str::FromStr>(&self, place: usize) -> Result<T, VerifyError> {
        let word = self.words.get(place).map(|word| word.parse());
        word.and_then(Result::ok).ok_or_else(|| self.refute(format!("word {} is no number", place + 1)))
    }

    /// The numbers after a keyword.
    fn numbers(&self, keyword: &str) -> Result<Vec<u32>, VerifyError> {
        if self.words.first().is_none_or(|word| word != keyword) {
            return Err(self.refute(format!("expected `{keyword}`")));
        }
        (1..self.words.len()).map(|place| self.number(place)).collect()
    }

    /// A proof by reductions, from its line `reduce`; leaves the reader on the line after it.
    fn reduced(&mut self, whole: Part, depth: usize) -> Result<f64, VerifyError> {
        if depth > DEPTH {
            return Err(self.refute("proofs are nested too deeply".into()));
        }
        if self.words.first().is_none_or(|word| word != "reduce") {
            return Err(self.refute("expected `reduce`".into()));
        }
        let pieces: usize = self.number(1)?;
        let mut parts: Vec<Part> = Vec::new();
        let mut whole = Some(whole);
        let mut bound = 0.0;
        self.next()?;
        for _ in 0..pieces {
            if self.words.first().is_none_or(|word| word != "piece") || self.words.len() < 2 {
                return Err(self.refute("expected `piece`".into()));
            }
            let names =
                (2..self.words.len()).map(|place| self.number(place)).collect::<Result<Vec<u32>, _>>()?;
            let mut part = if self.words[1] == "-" {
                whole.take().ok_or_else(|| self.refute("only the first piece is the whole".into()))?
            } else {
                let parent: usize = self.number(1)?;
                let parent = parts.get_mut(parent).ok_or_else(|| VerifyError::Refuted {
                    line: self.line,
                    reason: "there is no such piece yet".into(),
                })?;
                let split = parent.split(&names);
                split.map_err(|reason| self.refute(reason))?
            };
            self.next()?;
            while self.step(&mut part)? {
                self.next()?;
            }
            if self.words.first().is_some_and(|word| ["pack", "fix", "branch"].contains(&word.as_str())) {
                let kernel = part.take(&names).map_err(|reason| self.refute(reason))?;
                bound += self.proof(&kernel, depth)?;
            }
            parts.push(part);
        }
        // What no piece took counts as it is.
        parts.extend(whole);
        Ok(bound + parts.iter().map(|part| part.constant + part.negative_sum()).sum::<f64>())
    }

    /// Makes the reduction that the current line states; false if it states none.
    fn step(&mut self, part: &mut Part) -> Result<bool, VerifyError> {
        let made = match self.words.first().map(String::as_str) {
            Some("i") => part.isolate(self.number(1)?),
            Some("2") => part.eliminate(self.number(1)?),
            Some("d") => part.dominance(self.number(1)?, self.number(2)?),
            Some("t") => part.triangle(self.number(1)?, self.number(2)?, self.number(3)?),
            _ => return Ok(false),
        };
        made.map_err(|reason| self.refute(reason))?;
        Ok(true)
    }

    /// The proof of a kernel's bound; leaves the reader on the line after it.
    fn proof(&mut self, kernel: &Part, depth: usize) -> Result<f64, VerifyError> {
        let integral = kernel.is_integral();
        let round = |bound: f64| {
            if integral { (bound - 1e-6 * (1.0 + bound.abs() * 1e-6)).ceil() } else { bound }
        };
        match self.words[0].as_str() {
            "pack" => {
                let cycles = self.number(1)?;
                self.next()?;
                Ok(round(self.packing(kernel, cycles)?.1))
            }
            "fix" => {
                let (cycles, edges): (usize, usize) = (self.number(1)?, self.number(2)?);
                let reward: f64 = self.number(3)?;
                self.check_reward(reward)?;
                self.next()?;
                let (residual, bound) = self.packing(kernel, cycles)?;
                let mut rest = kernel.clone();
                let mut left_out = f64::INFINITY;
                for _ in 0..edges {
                    let (tail, head): (u32, u32) = (self.number(0)?, self.number(1)?);
                    let residual = residual.cost(tail.min(head), tail.max(head));
                    if kernel.cost(tail, head) <= 0.0 {
                        return Err(self.refute("only attractive edges can be fixed".into()));
                    }
                    left_out = left_out.min(round(bound + residual));
                    rest.add(tail, head, reward);
                    self.next()?;
                }
                Ok(self.reduced(rest, depth + 1)?.min(left_out))
            }
            _ => {
                let (tail, head): (u32, u32) = (self.number(1)?, self.number(2)?);
                let reward: f64 = self.number(3)?;
                self.check_reward(reward)?;
                if tail == head || kernel.has(&[tail, head]).is_err() {
                    return Err(self.refute("a branch needs two nodes".into()));
                }
                self.next()?;
                // Rewards hold for any amount: a joined pair does not pay it, a pair apart always does.
                let (mut joined, mut apart) = (kernel.clone(), kernel.clone());
                joined.add(tail, head, reward);
                apart.add(tail, head, -2.0 * reward);
                let joined = self.reduced(joined, depth + 1)?;
                let apart = self.reduced(apart, depth + 1)? + 2.0 * reward;
                Ok(joined.min(apart))
            }
        }
    }

    fn check_reward(&self, reward: f64) -> Result<(), VerifyError> {
        if reward.is_finite() && reward > 0.0 {
            Ok(())
        } else {
            Err(self.refute("a reward must be a positive number".into()))
        }
    }

    /// Residual capacities and bound of packed cycles; leaves the reader on the line after them.
    fn packing(&mut self, kernel: &Part, cycles: usize) -> Result<(Part, f64), VerifyError> {
        let mut residual = kernel.clone();
        for arcs in &mut residual.arcs {
            for cost in arcs.values_mut() {
                *cost = cost.abs();
            }
        }
        let mut bound = kernel.negative_sum();
        for _ in 0..cycles {
            let weight: f64 = self.number(0)?;
            let nodes =
                (1..self.words.len()).map(|place| self.number(place)).collect::<Result<Vec<u32>, _>>()?;
            if !(weight >= 0.0 && weight.is_finite()) || nodes.len() < 3 {
                return Err(self.refute("a cycle needs a weight and three nodes".into()));
            }
            let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
            let path = nodes.windows(2).map(|pair| (pair[0], pair[1], 1.0));
            for (tail, head, sign) in path.chain([(last, first, -1.0)]) {
                let cost = kernel.cost(tail, head) * sign;
                let key = (tail.min(head), tail.max(head));
                let left = residual.arcs.get_mut(key.0 as usize).and_then(|arcs| arcs.get_mut(&key.1));
                let left = match left {
                    Some(left) if cost > 0.0 => left,
                    _ => return Err(self.refute(format!("edge {tail} {head} has the wrong sign"))),
                };
                *left -= weight;
                if *left < -ROUNDING * cost {
                    return Err(self.refute(format!("edge {tail} {head} is packed beyond its cost")));
                }
                *left = left.max(0.0);
            }
            bound += weight;
            self.next()?;
        }
        Ok((residual, bound))
    }
}

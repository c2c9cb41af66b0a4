//! An independent check of certificates, which shares no algorithm with the solver.
//!
//! [`proof`] reads the statements, [`part`] repeats the reductions on its own graph, and [`packing`] checks signs, shape and
//! capacity of every conflict: for each edge, the weights of the conflicts that use it add up to at most its `|c|`. [`connection`]
//! computes flows between nodes that a proof joins, and [`tree`] checks proofs by cases.

mod connection;
mod packing;
mod part;
mod proof;
mod tree;
mod windows;

use std::io::BufRead;

use crate::certificate::proof::MAGIC;
use crate::graph::instance::Graph;
use part::Part;
use proof::Checker;

/// What a certificate proves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verified {
    /// Objective of the labels in the certificate.
    pub objective: f64,
    /// Proved lower bound: no multicut of the graph costs less.
    pub lower_bound: f64,
    /// Whether both are equal: exactly for integer costs, otherwise up to 10^-9 of the sum of absolute costs.
    pub optimal: bool,
}

/// The reason why a certificate proves nothing.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// The file could not be read.
    #[error("the certificate could not be read after line {line}: {cause}")]
    Read {
        /// Number of lines read before the error.
        line: usize,
        /// The error of the operating system.
        cause: std::io::Error,
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

/// Checks a certificate against a graph, in one pass over the file: the condition of each reduction, the signs and capacities
/// of each conflict, and that the parts of the graph share no edge. `O(log n)` for each edge touched. Each pair that a `fix` statement
/// joins takes as many searches as there are shortest paths in a sufficient flow between the two.
pub fn verify(graph: &Graph, certificate: impl BufRead) -> Result<Verified, VerifyError> {
    let mut checker = Checker::new(certificate);
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

//! Reader of plain instances: a line `MULTICUT`, then `u v cost` on each line.

use std::io::{BufRead, Read as _};

use posecut_graph::LONGEST_LINE;

use super::error::{GraphError, MAXIMUM_NODES};
use super::instance::{Edge, Graph};

/// The reason why a file is not an instance.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be read.
    #[error("the instance could not be read after line {line}: {cause}")]
    Read {
        /// Number of lines read before the error.
        line: usize,
        /// The error of the operating system.
        cause: std::io::Error,
    },
    /// The first line is not `MULTICUT`.
    #[error("line 1 is {found:?} instead of MULTICUT; is this an instance in the mc format?")]
    Header {
        /// The beginning of the line.
        found: String,
    },
    /// A line is not `u v cost`.
    #[error("line {line} is {found:?}; expected two node numbers and a cost, as in `0 1 -2.5`")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// The beginning of the line.
        found: String,
    },
    /// Node numbers are far larger than the number of edges explains.
    #[error("the largest node number is {}, but the number of edges is only {edges}; number the nodes from 0 without gaps", nodes - 1)]
    Sparse {
        /// The largest node number plus one.
        nodes: usize,
        /// The number of edges.
        edges: usize,
    },
    /// The edges do not make a graph.
    #[error("line {line}: {cause}")]
    Graph {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong with the edge.
        cause: GraphError,
    },
}

/// Up to this many nodes, any number of nodes may have no edge.
const SPARSE_NODES: usize = 1 << 20;

/// Above it, most nodes for each edge: otherwise one line with a large number would allocate gigabytes.
const SPARSE_RATIO: usize = 1000;

/// Reads an instance in the `mc` format. Nodes are numbered from 0 to the largest number in the file. Empty lines are
/// skipped.
///
/// Reads line by line, so that it needs no memory beyond the graph. Errors name the line.
pub fn read_mc(input: impl std::io::Read) -> Result<Graph, ReadError> {
    let mut input = std::io::BufReader::with_capacity(1 << 20, input);
    let mut line = Vec::new();
    let mut number = 0;
    let mut edges = Vec::new();
    let (mut node_count, mut self_loops, mut magnitude) = (0usize, 0, 0.0);
    let mut header = false;
    loop {
        line.clear();
        let read = input.by_ref().take(LONGEST_LINE + 1).read_until(b'\n', &mut line);
        let read = read.map_err(|cause| ReadError::Read { line: number, cause })?;
        if read == 0 {
            break;
        }
        if read as u64 > LONGEST_LINE {
            return Err(ReadError::Line { line: number + 1, found: excerpt(&line) });
        }
        number += 1;
        let text = line.trim_ascii();
        if !header {
            if text != b"MULTICUT" {
                return Err(ReadError::Header { found: excerpt(text) });
            }
            header = true;
            continue;
        }
        if text.is_empty() {
            continue;
        }
        let (tail, head, cost) =
            parse(text).ok_or_else(|| ReadError::Line { line: number, found: excerpt(text) })?;
        let refuse = |cause| ReadError::Graph { line: number, cause };
        let largest = tail.max(head);
        if largest >= MAXIMUM_NODES as u64 {
            return Err(refuse(GraphError::TooManyNodes { nodes: largest.saturating_add(1) }));
        }
        if !cost.is_finite() {
            return Err(refuse(GraphError::CostNotFinite {
                edge: edges.len() + self_loops,
                tail,
                head,
                cost,
            }));
        }
        magnitude += cost.abs();
        node_count = node_count.max(largest as usize + 1);
        if tail == head {
            self_loops += 1;
        } else if edges.len() >= u32::MAX as usize {
            return Err(refuse(GraphError::TooManyEdges));
        } else {
            edges.push(Edge { tail: tail as u32, head: head as u32, cost });
        }
    }
    if !header {
        return Err(ReadError::Header { found: String::new() });
    }
    if node_count > SPARSE_NODES && node_count / SPARSE_RATIO > edges.len() + self_loops {
        return Err(ReadError::Sparse { nodes: node_count, edges: edges.len() + self_loops });
    }
    if !f64::is_finite(magnitude) {
        return Err(ReadError::Graph { line: number, cause: GraphError::CostsOverflow });
    }
    edges.shrink_to_fit();
    Ok(Graph::from_checked(node_count, edges, self_loops))
}

fn excerpt(text: &[u8]) -> String {
    String::from_utf8_lossy(&text[..text.len().min(40)]).into_owned()
}

fn parse(text: &[u8]) -> Option<(u64, u64, f64)> {
    let mut fields = text.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty());
    let edge = (integer(fields.next()?)?, integer(fields.next()?)?, cost(fields.next()?)?);
    fields.next().is_none().then_some(edge)
}

fn integer(digits: &[u8]) -> Option<u64> {
    if digits.is_empty() || digits.len() > 19 {
        // Node numbers with more than 19 digits are rejected as too large, not as malformed.
        let all = !digits.is_empty() && digits.iter().all(u8::is_ascii_digit);
        return all.then_some(u64::MAX);
    }
    digits
        .iter()
        .try_fold(0u64, |value, digit| digit.is_ascii_digit().then(|| value * 10 + u64::from(digit - b'0')))
}

fn cost(text: &[u8]) -> Option<f64> {
    // Fast path: most costs are single digits.
    match text {
        [digit @ b'0'..=b'9'] => Some(f64::from(digit - b'0')),
        [b'-', digit @ b'1'..=b'9'] => Some(-f64::from(digit - b'0')),
        _ => std::str::from_utf8(text).ok()?.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        read_mc(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn reads_edges_with_any_spacing() {
        let graph = read_mc("MULTICUT\n0 1 -1\n\n 2\t1 2.5e-1 \r\n3 3 7\n".as_bytes()).unwrap();
        assert_eq!((graph.node_count(), graph.self_loops()), (4, 1));
        assert_eq!(graph.edges()[1], Edge { tail: 2, head: 1, cost: 0.25 });
        assert_eq!(read_mc("MULTICUT".as_bytes()).unwrap().node_count(), 0);
    }

    #[test]
    fn errors_name_line_and_reason() {
        assert!(message("").contains("instead of MULTICUT"));
        assert!(message("MULTICUT\n0 1\n").starts_with("line 2 is \"0 1\""));
        assert!(message("MULTICUT\n0 1 1 1\n").contains("two node numbers"));
        assert!(message("MULTICUT\n0 -1 1\n").contains("two node numbers"));
        assert!(message("MULTICUT\n0 1 nan\n").contains("costs NaN"));
        assert!(message("MULTICUT\n0 1 1e999\n").contains("costs inf"));
        assert!(message("MULTICUT\n0 99999999999999999999999 1\n").contains("more than the"));
        assert!(message("MULTICUT\n0 268435455 1\n").contains("the number of edges is only 1;"));
    }
}

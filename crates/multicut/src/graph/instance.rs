//! The signed graph to cut.

use super::error::{GraphError, LabelError, MAXIMUM_NODES};
use super::sum::Sum;

/// An edge with its cost: edges with positive costs attract (a multicut pays for cutting them), those with negative costs repel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// One end.
    pub tail: u32,
    /// The other end; never equal to `tail`.
    pub head: u32,
    /// Cost of cutting the edge; finite.
    pub cost: f64,
}

/// A graph with real edge costs.
///
/// Parallel edges are allowed, and their costs add up. Self-loops can never be cut; they are left out and counted. An edge of
/// cost 0 changes no objective, so it neither attracts nor repels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Graph {
    node_count: usize,
    edges: Vec<Edge>,
    self_loops: usize,
}

impl Graph {
    /// Builds a graph from its number of nodes and its edges `(end, other end, cost)`.
    ///
    /// Linear in the number of edges. Rejects costs that are not finite, unknown nodes, and graphs beyond [`MAXIMUM_NODES`];
    /// the error names the edge.
    ///
    /// ```
    /// use posecut_multicut::Graph;
    /// let graph = Graph::new(3, [(0, 1, 1.0), (1, 2, 1.0), (2, 0, -3.0)])?;
    /// assert_eq!(graph.objective(&[0, 0, 1])?, -2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        node_count: usize,
        edges: impl IntoIterator<Item = (u64, u64, f64)>,
    ) -> Result<Self, GraphError> {
        if node_count > MAXIMUM_NODES {
            return Err(GraphError::TooManyNodes { nodes: node_count as u64 });
        }
        let edges = edges.into_iter();
        let mut graph =
            Self { node_count, edges: Vec::with_capacity(edges.size_hint().0.min(1 << 24)), self_loops: 0 };
        let mut magnitude = 0.0;
        for (edge, (tail, head, cost)) in edges.enumerate() {
            if tail >= node_count as u64 || head >= node_count as u64 {
                return Err(GraphError::UnknownNode { edge, tail, head, nodes: node_count });
            }
            if !cost.is_finite() {
                return Err(GraphError::CostNotFinite { edge, tail, head, cost });
            }
            magnitude += cost.abs();
            graph.push(tail as u32, head as u32, cost)?;
        }
        if magnitude.is_finite() { Ok(graph) } else { Err(GraphError::CostsOverflow) }
    }

    /// Adds an edge with checked ends and cost.
    fn push(&mut self, tail: u32, head: u32, cost: f64) -> Result<(), GraphError> {
        if tail == head {
            self.self_loops += 1;
        } else if self.edges.len() >= u32::MAX as usize {
            return Err(GraphError::TooManyEdges);
        } else {
            self.edges.push(Edge { tail, head, cost });
        }
        Ok(())
    }

    /// Builds a graph from edges whose ends and costs were checked by the reader.
    pub(crate) fn from_checked(node_count: usize, edges: Vec<Edge>, self_loops: usize) -> Self {
        Self { node_count, edges, self_loops }
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.node_count
    }

    /// The edges in the order given, without self-loops.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The number of self-loops left out.
    pub fn self_loops(&self) -> usize {
        self.self_loops
    }

    /// Whether some edge repels. If none does, joining everything is optimal.
    pub fn has_repulsive_edges(&self) -> bool {
        self.edges.iter().any(|edge| edge.cost < 0.0)
    }

    /// Cost of the edges whose ends have different labels: the objective of the multicut that `labels` define.
    ///
    /// The sum is compensated, so that the order of the edges hardly matters.
    pub fn objective(&self, labels: &[u32]) -> Result<f64, LabelError> {
        if labels.len() != self.node_count {
            return Err(LabelError { labels: labels.len(), nodes: self.node_count });
        }
        let mut sum = Sum::default();
        for edge in &self.edges {
            if labels[edge.tail as usize] != labels[edge.head as usize] {
                sum.add(edge.cost);
            }
        }
        Ok(sum.value())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn self_loops_are_left_out_and_counted() {
        let graph = Graph::new(2, [(0, 0, -5.0), (0, 1, 1.0), (1, 1, f64::MAX)]).unwrap();
        assert_eq!((graph.edges().len(), graph.self_loops()), (1, 2));
    }

    #[test]
    fn bad_edges_are_refused_by_position() {
        let not_a_number = Graph::new(2, [(0, 1, 1.0), (1, 0, f64::NAN)]).unwrap_err();
        assert!(not_a_number.to_string().starts_with("edge 1 (1, 0) costs NaN"));
        let infinite = Graph::new(2, [(0, 1, f64::NEG_INFINITY)]).unwrap_err();
        assert!(matches!(infinite, GraphError::CostNotFinite { edge: 0, .. }));
        let unknown = Graph::new(2, [(0, u64::MAX, 1.0)]).unwrap_err();
        assert!(matches!(unknown, GraphError::UnknownNode { edge: 0, nodes: 2, .. }));
        let sum = Graph::new(3, [(0, 1, f64::MAX), (1, 2, f64::MAX)]).unwrap_err();
        assert_eq!(sum, GraphError::CostsOverflow);
        let huge = Graph::new(usize::MAX, []).unwrap_err();
        assert!(matches!(huge, GraphError::TooManyNodes { .. }));
    }

    #[test]
    fn an_objective_needs_one_label_a_node() {
        let graph = Graph::new(3, [(0, 1, 1.0)]).unwrap();
        assert_eq!(graph.objective(&[0, 1]), Err(LabelError { labels: 2, nodes: 3 }));
    }
}

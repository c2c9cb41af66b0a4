//! Errors in graphs and in labels.

/// Most nodes of a graph: labels, and each further table by node, then need about one gigabyte.
pub const MAXIMUM_NODES: usize = 1 << 28;

/// The reason why edges do not make a graph.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GraphError {
    /// More nodes than [`MAXIMUM_NODES`].
    #[error(
        "the graph has {nodes} nodes, more than the {MAXIMUM_NODES} that are supported; number its nodes from 0 without gaps"
    )]
    TooManyNodes {
        /// The requested number of nodes.
        nodes: u64,
    },
    /// More edges than 32-bit indices allow.
    #[error("the graph has more than {} edges; add up the costs of parallel edges first", u32::MAX)]
    TooManyEdges,
    /// An end of an edge is not a node of the graph.
    #[error(
        "edge {edge} joins nodes {tail} and {head}, but there are {nodes} nodes, numbered from 0; raise the node count or correct the edge"
    )]
    UnknownNode {
        /// Position of the edge in the input, counted from 0.
        edge: usize,
        /// First end as given.
        tail: u64,
        /// Second end as given.
        head: u64,
        /// Number of nodes of the graph.
        nodes: usize,
    },
    /// A cost that is infinite or not a number.
    #[error("edge {edge} ({tail}, {head}) costs {cost}; a cost must be a finite number")]
    CostNotFinite {
        /// Position of the edge in the input, counted from 0.
        edge: usize,
        /// First end.
        tail: u64,
        /// Second end.
        head: u64,
        /// The cost as given.
        cost: f64,
    },
    /// Finite costs whose absolute sum is infinite.
    #[error("the absolute costs add up to infinity; divide all costs by a common factor")]
    CostsOverflow,
}

/// The reason why labels do not describe a partition of a graph's nodes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there are {labels} labels for {nodes} nodes; give one label for each node")]
pub struct LabelError {
    /// Number of labels given.
    pub labels: usize,
    /// Number of nodes of the graph.
    pub nodes: usize,
}

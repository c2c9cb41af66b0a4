//! What can be wrong with a graph or a set of labels.

/// Most nodes a graph may have: labels, and the tables beside them, stay near one gigabyte each.
pub const MAXIMUM_NODES: usize = 1 << 28;

/// Why edges do not make a graph.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GraphError {
    /// More nodes than [`MAXIMUM_NODES`].
    #[error(
        "the graph has {nodes} nodes, more than the {MAXIMUM_NODES} that are supported; number its nodes from 0 without gaps"
    )]
    TooManyNodes {
        /// The number of nodes asked for.
        nodes: u64,
    },
    /// More edges than 32-bit indices can name.
    #[error("the graph has more than {} edges; add parallel edges up before building it", u32::MAX)]
    TooManyEdges,
    /// An end of an edge is no node.
    #[error(
        "edge {edge} joins {tail} and {head}, but the graph has only nodes 0 to {nodes} (exclusive); raise the node count or correct the edge"
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
    /// A cost that is not a number, or infinite.
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
    /// Finite costs whose absolute sum is not.
    #[error("the absolute costs add up to infinity; divide all costs by a common factor")]
    CostsOverflow,
}

/// Why labels do not describe a partition of a graph's nodes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there are {labels} labels for {nodes} nodes; give one label for each node")]
pub struct LabelError {
    /// Number of labels given.
    pub labels: usize,
    /// Number of nodes of the graph.
    pub nodes: usize,
}

//! Minimum-cost multicuts of signed graphs.
//!
//! A *multicut* is the set of edges between the clusters of a partition of the nodes. With a cost `c` for cutting each edge
//! (positive: its ends attract each other; negative: they repel) the problem is to find the partition with
//! the least total cost of cut edges: correlation clustering, with the number of clusters left free. It is NP-hard
//! in general; on sparse graphs, reductions leave kernels so small that the optimum is found and proved.
//!
//! ```
//! use posecut_multicut::{Graph, Options, solve};
//! // Two pairs that hold together, and a weak tie between them that a repulsive edge outweighs.
//! let graph = Graph::new(4, [(0, 1, 2.0), (2, 3, 2.0), (1, 2, 0.5), (0, 3, -1.0)])?;
//! let solution = solve(&graph, &Options::default());
//! assert_eq!(solution.labels, [0, 0, 1, 1]);
//! assert_eq!((solution.objective, solution.optimal), (-0.5, true));
//! # Ok::<(), posecut_multicut::GraphError>(())
//! ```
#![doc = include_str!("../docs/method.md")]

mod bisection;
mod blocks;
mod budget;
mod canonical;
mod clique_matrix;
mod cluster_graph;
pub mod command;
mod conflict;
mod contraction_queue;
mod cycle_separation;
mod decomposition;
pub mod delta;
mod error;
pub mod generate;
mod graph;
mod greedy;
mod interior_point;
mod kernel;
mod kernighan_lin;
mod landmark_distances;
mod landmarks;
mod local_search;
mod node_moves;
mod options;
mod packing;
mod proof;
mod read;
mod reduction;
mod relaxation;
mod search;
mod signed_graph;
mod solve;
pub mod stage;
mod start;
mod sum;
pub mod support;
mod union_find;
mod verified_packing;
mod verified_part;
mod verified_proof;
mod verify;
mod wheel_separation;

pub use error::{GraphError, LabelError, MAXIMUM_NODES};
pub use graph::{Edge, Graph};
pub use options::{Options, Solver};
pub use proof::Certificate;
pub use read::{ReadError, read_mc};
pub use solve::{Solution, solve};
pub use verify::{Verified, VerifyError, verify};

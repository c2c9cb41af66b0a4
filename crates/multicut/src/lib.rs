//! Minimum-cost multicuts of signed graphs.
//!
//! A *multicut* is the set of edges between the clusters of a partition of the nodes. With a cost `c` for cutting each edge
//! (positive: its ends attract each other; negative: they repel), the problem is to find the partition with the least total
//! cost of cut edges. This is correlation clustering, with the number of clusters left free. It is NP-hard in general. On
//! sparse graphs, reductions leave kernels so small that the solver finds the optimum and proves it.
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
//!
//! # Modules
//!
//! Each folder of `src` covers one part of the theory, and the module of the same name states its equations. Each module
//! depends only on those before it:
//!
//! - `graph`: signed graphs, their input format and generators.
//! - `bound`: packings, the cycle relaxation, odd wheels.
//! - `reduce`: reductions that keep an optimum, and independent blocks.
//! - `heuristics`: greedy contraction, Kernighan-Lin with joins, fusion moves.
//! - `certificate`: proofs of lower bounds, and their independent check.
//! - `solve`: the whole graph, and branch and cut on kernels.
//! - `costs`: costs of landmark edges from support.
//! - `stage`: the multicut of a pose graph, with the feature `cli`.
//!
//! `budget` limits the work of all modules, and `options` holds the caller's choices.
#![doc = include_str!("../docs/method.md")]

mod bound;
mod budget;
mod certificate;
#[cfg(feature = "cli")]
pub mod cli;
mod costs;
mod graph;
mod heuristics;
mod options;
mod reduce;
mod solve;
#[cfg(feature = "cli")]
pub mod stage;

pub use certificate::proof::Certificate;
pub use certificate::verify::{Verified, VerifyError, verify};
pub use costs::{delta, support};
pub use graph::error::{GraphError, LabelError, MAXIMUM_NODES};
pub use graph::generate;
pub use graph::instance::{Edge, Graph};
pub use graph::read::{ReadError, read_mc};
pub use graph::small_and_hard;
pub use options::{Options, Solver};
pub use solve::{Solution, solve};

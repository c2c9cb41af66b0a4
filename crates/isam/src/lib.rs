//! Incremental optimisation: poses and edges are added one at a time, edges can be retracted, and the estimate stays current.
//!
//! The solver keeps the estimate as iSAM2 does (Kaess, Johannsson, Roberts, Ila, Leonard, Dellaert, "iSAM2: Incremental
//! smoothing and mapping using the Bayes tree", IJRR 2012): in a tree of cliques. Each clique is the elimination of its
//! *frontal* variables given its *separator*. A change to an edge affects the cliques of its two ends and their ancestors.
//! The solver removes this top of the tree, orders its variables anew with the newest last, and eliminates them again. The
//! subtrees below stay: each contributes the update that it left on its separator.
//!
//! Differences from the paper, and why the result is the same:
//!
//! - A clique is a dense front of the multifrontal Cholesky factorisation of the normal equations, with the right-hand side
//!   as one more row, instead of a QR factorisation of Jacobians. The front's update matrix is stored with it: it is what a
//!   subtree leaves on its separator, the information form of the paper's boundary factor. Both methods have the same factor
//!   `L` up to signs.
//! - The order comes from a minimum-degree algorithm on the quotient graph. The remaining subtrees are elements from the
//!   start and are not expanded to pairs.
//! - A linearised edge is kept until one of its ends is relinearised. Thresholds per variable decide which variables may be
//!   relinearised. All of them are, at once, when the differences between residuals and linear models add up to more than a
//!   share of the cost ([`IncrementalOptions::linearisation_error`]). A component that swings rigidly has no such
//!   differences.
//! - Not only the ends of the newest edges come last in the order, but the nearest half (by distance in the graph) of all
//!   nodes that are eliminated again: the next edges will probably end there.
//! - The gauge is not a prior: the first pose of every connected component is a constant. When an edge joins two components,
//!   the later one moves rigidly so that the edge fits; since errors are right perturbations, nothing is relinearised. When a
//!   removal splits a component, the side without a gauge keeps its poses and gets a gauge, and the report names it.
//!
//! - Marginalised poses ([`IncrementalSolver::marginalise`], [`IncrementalOptions::lag`]) leave a prior over the poses around
//!   them: a clique without frontal variables, whose update matrix is the prior's quadratic model. To the rest of the tree it
//!   is a subtree that stays.
//!
//! Removal is exact: after [`IncrementalSolver::finish`] the estimate is that of a fresh solution of the remaining edges.
//!
//! ```
//! use nalgebra::Matrix3;
//! use posecut_geometry::{LieGroup, SE2};
//! use posecut_isam::{IncrementalOptions, IncrementalSolver};
//! use posecut_optimize::{Edge, EdgeKind};
//!
//! let mut solver = IncrementalSolver::new(IncrementalOptions::default())?;
//! let step = SE2::new(1.0, 0.0, std::f64::consts::FRAC_PI_2);
//! let mut here = solver.add_pose(SE2::identity())?;
//! for _ in 0..3 {
//!     let next = solver.add_pose(SE2::identity())?;
//!     solver.add_edge(Edge::new(here, next, step, Matrix3::identity(), EdgeKind::Odometry))?;
//!     solver.update();
//!     here = next;
//! }
//! let wrong = solver.add_edge(Edge::new(here, 0, SE2::new(9.0, 0.0, 0.0), Matrix3::identity(), EdgeKind::Landmark))?;
//! solver.update();
//! solver.remove_edge(wrong)?;
//! solver.finish();
//! assert!(solver.cost() < 1e-12);
//! # Ok::<(), posecut_isam::IncrementalError>(())
//! ```

#[cfg(feature = "cli")]
pub mod cli;
mod cliques;
mod covariance;
mod degrees;
mod edges;
mod elimination;
mod error;
mod estimate;
mod finish;
mod gauges;
mod incremental_group;
mod lag;
mod linear_model;
mod marginalise;
mod movement;
mod options;
mod order;
mod parts;
mod prior;
mod priors;
mod report;
mod restarts;
mod solver;
#[cfg(feature = "cli")]
pub mod stage;
mod substitution;
mod supervariables;
mod top;
mod tree;
mod update;

pub use error::IncrementalError;
pub use incremental_group::IncrementalGroup;
pub use options::IncrementalOptions;
pub use report::{FinishReport, Split, UpdateReport};
pub use solver::{EdgeId, IncrementalSolver};

//! Incremental optimisation: poses and edges come one at a time, edges can be taken back, and the estimate stays current.
//!
//! The estimate is kept as iSAM2 keeps it (Kaess, Johannsson, Roberts, Ila, Leonard, Dellaert, "iSAM2: Incremental
//! smoothing and mapping using the Bayes tree", IJRR 2012): a tree of cliques, each the elimination of its *frontal*
//! variables given its *separator*. A change to an edge touches the cliques of its two ends and their ancestors. That
//! top is taken away, its variables are ordered anew with the newest last, and eliminated again; subtrees below it stay
//! and enter by what they have left over on their separators.
//!
//! What differs from the paper, and why the result is the same:
//!
//! - A clique is a dense front of the multifrontal Cholesky factorisation of the normal equations, with the right-hand
//!   side as one more row, instead of a QR factorisation of Jacobians. What a subtree leaves over on its separator is the
//!   front's update matrix, which stays stored with it: the information form of the paper's boundary factor. The factor
//!   `L` of both is the same up to signs.
//! - The order comes from a minimum-degree algorithm on the quotient graph, in which the remaining subtrees are elements
//!   from the start; nothing is expanded to pairs.
//! - Linearised edges are kept until one of their ends is relinearised. Thresholds per variable tell which variables may be;
//!   they are, all at once, when the differences between residuals and linear models add up to more than a share of
//!   the cost ([`IncrementalOptions::linearisation_error`]). A part that swings rigidly leaves its linear models exact.
//! - What comes last in the order is not only the ends of the newest edges but half of what is eliminated again, by distance
//!   from them in the graph: the next edges come there.
//! - The gauge is not a prior: the first pose of every connected part stays where it is and is no variable. When an edge
//!   joins two parts, the later one moves rigidly so that the edge fits. Errors are right perturbations, so that
//!   nothing needs to be linearised again. When a removal splits a part, the one without gauge stays where it is and gets
//!   one, and the report says so.
//!
//! Removal is no approximation. After [`IncrementalSolver::finish`] the estimate is that of a fresh solution of the edges
//! that are left.
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

mod cliques;
mod degrees;
mod edges;
mod elimination;
mod error;
mod estimate;
mod finish;
mod gauges;
mod linear_model;
mod movement;
mod options;
mod order;
mod parts;
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
pub use options::IncrementalOptions;
pub use report::{FinishReport, Split, UpdateReport};
pub use solver::{EdgeId, IncrementalSolver};

//! Batch pose-graph optimisation on SE(2) and SE(3).
//!
//! Minimises `sum of rho(e^T Omega e)` with `e = Log(Z^-1 X_from^-1 X_to)` over the poses `X` of a graph, where an edge
//! measures `Z` with information matrix `Omega`, and `rho` is the identity or a robust kernel. Priors measure single nodes:
//! `e = Log(Z^-1 X)` for a pose, `e = t - z` for a position.
//!
//! 1. [`Problem`] checks a graph; [`connected_components`](posecut_graph::connectivity::connected_components) splits it into
//!    its connected components. Each is solved on its own; its first node keeps its pose, unless
//!    priors fix it.
//! 2. [`initialisation`] proposes starts: the given poses, a spanning tree, and the chordal relaxation, which finds all
//!    rotations first. The start of lowest cost is taken.
//! 3. [`optimize`] takes Gauss-Newton steps, damped (Levenberg-Marquardt) once one fails, with posecut's own sparse Cholesky
//!    factorisation ([`posecut_cholesky`]) of 3 x 3 or 6 x 6 blocks.
//! 4. [`Marginals`] computes covariances of poses and of pairs of them from the factor.
//!
//! Each folder of `src` holds one piece of theory; the module of the same name cites its equations. The modules depend on
//! each other in this order: [`model`], `normal_equations`, [`initialisation`], `descent`, `effort`, `certificate`, `lifted`, `pose_group`,
//! `batch`, `covariance`, and `stage`, which reads its graph by [`pose_graph`]. Without the feature `cli`, which is on by
//! default, the crate has no stage and no program, and depends neither on clap nor on posecut-stage.
//!
//! ```
//! use nalgebra::Matrix3;
//! use posecut_geometry::{LieGroup, SE2};
//! use posecut_optimize::{Edge, EdgeKind, Options, Problem, optimize};
//!
//! let step = SE2::new(1.0, 0.0, std::f64::consts::FRAC_PI_2);
//! let mut edges: Vec<_> = (0..3).map(|i| Edge::new(i, i + 1, step, Matrix3::identity(), EdgeKind::Odometry)).collect();
//! edges.push(Edge::new(3, 0, SE2::new(1.1, 0.0, 1.6), Matrix3::identity(), EdgeKind::Landmark));
//! let problem = Problem::new(vec![SE2::identity(); 4], edges)?;
//! let solution = optimize(&problem, &Options::default());
//! assert!(solution.converged && solution.chi_square < 0.01);
//! # Ok::<(), posecut_optimize::ProblemError>(())
//! ```

mod batch;
mod certificate;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "cli")]
pub mod command;
mod covariance;
mod descent;
mod effort;
pub mod initialisation;
mod lifted;
pub mod model;
mod normal_equations;
mod options;
pub mod pose_graph;
mod pose_group;
#[cfg(feature = "cli")]
pub mod stage;

pub use batch::certify::{certify, certify_and_refine};
pub use batch::solution::{ComponentReport, Solution, Start};
pub use batch::solve::optimize;
pub use certificate::Certificate;
pub use covariance::at_solution::optimize_with_marginals;
pub use covariance::marginals::{Joint, Marginals};
pub use descent::outcome::Termination;
pub use descent::phases::Phases;
pub use model::cost::chi_square;
pub use model::kernel::Kernel;
pub use model::kernel_name::KernelNameError;
pub use model::prior::{Prior, PriorError};
pub use model::problem::{Edge, EdgeKind, Problem, ProblemError};
pub use model::residual::residual;
pub use options::{Graduated, Initialisation, Method, Options};
pub use pose_group::PoseGroup;
pub use posecut_cholesky::Memory;

//! The model: poses, edges with their residuals and robust kernels, and the graph they make.
//!
//! The cost is `sum of rho(e^T Omega e)` with `e = Log(Z^-1 X_from^-1 X_to)`, where an edge measures `Z` with information
//! matrix `Omega`; `prior` has the residuals of measurements of single nodes. `problem` checks a graph; `residual` has `e` and its
//! Jacobians, and `lanes` those of several edges at once; `quadratic` has the models that steps minimise, `term` what the solver asks of a
//! summand, and `cost` the sums; `retraction` moves poses by steps; `kernel` has `rho`, and `kernel_name` the names of kernels; `gauge` has the
//! held nodes; `part` makes a graph of a connected component; `magnitude` has the reference values of tolerances.
//!
//! Depends on no other module of this crate.

pub(crate) mod cost;
pub(crate) mod curvature;
pub(crate) mod gauge;
pub(crate) mod kernel;
pub(crate) mod kernel_name;
pub(crate) mod lanes;
pub(crate) mod magnitude;
pub(crate) mod part;
pub(crate) mod prior;
pub(crate) mod problem;
pub(crate) mod quadratic;
pub(crate) mod residual;
pub(crate) mod retraction;
pub(crate) mod term;

pub use kernel::charge;
pub use lanes::LaneGroup;
pub use magnitude::{Magnitude, distance, size};
pub use problem::{check_edge, is_finite};
pub use quadratic::{Gradient, Linearised};
pub use residual::Expansion;
pub use term::{Link, Term};

//! Pairs of landmark edges: whether two of them are consistent, and the graph of those that are.
//!
//! Two landmark edges `Z_a` (from pose i of chain A to pose k of chain B) and `Z_b` (from j to l) close the loop
//!
//! ```text
//! E = Z_a^-1 (P_i^-1 P_j) Z_b (Q_l^-1 Q_k)                      (Mangelson et al., ICRA 2018, equation 6)
//! ```
//!
//! and are consistent if `Log(E)^T Sigma^-1 Log(E)` is at most the quantile of chi-square with 3 or 6 degrees of freedom,
//! where `Sigma` adds the covariances of both edges and of both stretches of odometry. [`candidate`] orients the edges
//! alike and groups them by chains. [`distance`] computes the left side, [`gate`] the right side. [`pretest`] rejects most
//! pairs without the distance, and [`consistency`] builds the graph of all pairs. [`block`] and [`logarithm`] test
//! several pairs at once, in [`lanes`](posecut_geometry::lanes); [`nearest`] finds neighbours by distance travelled.
//!
//! Depends on `odometry` and on the bit rows of [`clique`](crate::clique).

pub(crate) mod block;
pub mod candidate;
pub mod consistency;
pub mod distance;
pub(crate) mod gate;
pub(crate) mod logarithm;
pub mod nearest;
pub mod pretest;

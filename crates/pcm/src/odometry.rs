//! Odometry: poses and covariances accumulated along chains, so that any stretch costs O(1).
//!
//! With poses `P_n` in the frame of a chain's first node and step covariances `Q_n`, [`chain`] accumulates
//!
//! ```text
//! S_(n+1) = S_n + Ad(P_(n+1)) Q_n Ad(P_(n+1))^T,    covariance of the stretch from i to j: S_j - S_i,
//! ```
//!
//! exact to first order for independent steps. [`spread`] bounds the largest eigenvalue of the translation's covariance at a
//! point `q`, by the trace `tr S_rho + 2 q . c + q^T (tr S_omega I - S_omega) q`; its terms accumulate likewise.
//!
//! Depends on no other module of this crate.

pub mod chain;
pub(crate) mod spread;

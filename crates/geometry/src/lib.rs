//! Rigid motions of the plane and of space, as Lie groups.
//!
//! [`SE2`] and [`SE3`] implement one trait, [`LieGroup`], so that pose-graph algorithms are written once for both.
//!
//! # Conventions
//!
//! - Metres and radians, right-handed frames; a pose maps coordinates in its own frame to coordinates in its reference frame.
//! - A tangent vector holds the translation first, then the rotation: `[x, y, theta]` and `[x, y, z, rx, ry, rz]`.
//! - Errors are *right* perturbations, `T = T_hat Exp(xi)`, and every covariance is the covariance of such a `xi`.
//! - [`LieGroup::exp`] is the exponential of the group, not the product of a translation and a rotation.
//!
//! ```
//! use posecut_geometry::{LieGroup, SE2};
//!
//! let first = SE2::new(1.0, 2.0, 0.5);
//! let second = SE2::new(2.0, 2.5, -3.0);
//! let measurement = first.between(&second);
//! let difference = first.compose(&measurement).between(&second).log();
//! assert!(difference.norm() < 1e-12);
//! ```

mod angle;
pub mod covariance;
pub mod geodetic;
pub mod interpolation;
pub mod lanes;
mod lie_group;
mod se2;
mod se3;
mod so3;
pub mod trigonometric;

pub use angle::wrap_angle;
pub use lie_group::{LieGroup, translations};
pub use se2::SE2;
pub use se3::SE3;

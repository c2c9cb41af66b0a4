//! Batch optimisation: from a checked graph to its minimum.
//!
//! [`solve`] takes the connected components one after the other. [`component`] chooses one of the [`starts`] of each, and
//! descends from it.
//! [`graduated`] makes the cost less convex round by round (Yang, Antonante, Tzoumas, Carlone, IEEE RA-L 5(2), 2020,
//! equations 12 and 14), and [`graduated_component`] does so from several starts. [`continuation`] finds a start where rotations are
//! noisy. [`certify`] computes the certificate of every component.
//!
//! Depends on [`model`](crate::model), [`initialisation`](crate::initialisation), `descent`, `lifted`, `certificate` and `pose_group`.

pub(crate) mod certify;
mod component;
mod continuation;
mod graduated;
mod graduated_component;
pub(crate) mod solution;
pub(crate) mod solve;
mod starts;

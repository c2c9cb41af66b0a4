//! The tests of geometry, in one program.

#[path = "../homogeneous/mod.rs"]
mod homogeneous;
#[path = "../tangents/mod.rs"]
mod tangents;

mod covariance;
mod group_laws;
mod pose_formats;

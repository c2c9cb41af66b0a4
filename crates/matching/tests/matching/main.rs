//! Tests of matching on scans of simulated rooms.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod correlative;
mod icp;
mod laser_odometry;
mod rooms;
mod sight;
mod thinning;

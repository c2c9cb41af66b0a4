//! The tests of conversions, in one program.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod closures;
mod closures_refused;
mod evo;
mod hostile_lines;
mod jrl;
mod jrl_refused;
mod odometry_rules;
mod priors;
mod program;
mod round_trip;
mod sessions;
mod several_files;
mod toro;
mod trajectories;

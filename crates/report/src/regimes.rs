//! The map of regimes: where a method helps, is neutral, or hurts, depending on the scale of the odometry's covariance
//! and the share of false edges.
//!
//! - [`statistics`]: confidence intervals and tests over seeds.
//! - `runs`: assigns runs to the cells of the map.
//! - [`map`]: means and intervals of every cell, and the effect of the graph cut in every cell.
//! - [`table`]: the map as Markdown and CSV.
//! - [`document`]: the tables of docs/results/regimes.md.

pub mod document;
pub mod map;
mod runs;
pub mod statistics;
pub mod table;

pub use map::{Cell, Comparison, Effect, Map, MethodMap, Verdict};

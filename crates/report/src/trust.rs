//! The trust benchmark: every method on every family of graphs, what each gets wrong, and which one to use.
//!
//! - [`records`]: the results and CPU times of runs, read strictly.
//! - [`benchmark`]: runs with the outcome of every method, and its regret.
//! - [`bootstrap`]: intervals from clusters of runs that are not independent.
//! - [`summary`]: a method's results on one family, or on all of them.
//! - [`reliability`]: how well probabilities of edges are calibrated.
//! - [`tables`], [`comparison`], [`recommendation`]: the tables, and the recommendation in sentences.
//! - [`joined`]: how far from the ground truth what a method joins is.
//! - [`misses`]: the runs beyond the bound, beside the ground truth.
//! - [`document`]: tables and recommendation as the sections of docs/trust.md.

pub mod benchmark;
pub mod bootstrap;
pub mod comparison;
pub mod document;
pub mod joined;
pub mod misses;
pub mod recommendation;
pub mod records;
pub mod reliability;
pub mod summary;
pub mod tables;

pub use benchmark::{Benchmark, Run, Status};
pub use records::Half;

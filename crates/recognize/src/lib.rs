//! Landmark edges from sensor data: which keyframes see the same place, and where one is in the frame of the other.
//!
//! - [`places`]: keyframes are described by a polar context of their surroundings ([`polar_context`]) and looked up by its key ([`keys`]).
//! - [`scan_context`], [`spatial`], [`velodyne`]: the same of three-dimensional scans.
//! - [`appearance`]: the probability that two keyframes see one place, by words ([`Words`], [`vocabulary`], [`chow_liu`]).
//! - [`measure`]: scan matching without a start, and how far both agree about what they saw.
//! - [`recognition`]: all of it, from a graph with scans to [`Candidate`](recognition::Candidate)s.
//!
//! Nothing here reads `truth`. Lengths are metres, angles radians. The same input gives the same candidates at any number of threads.

pub mod appearance;
pub mod chow_liu;
#[cfg(feature = "cli")]
pub mod cli;
pub mod columns;
pub mod hypotheses;
mod k_means;
pub mod keys;
pub mod measure;
pub mod places;
pub mod polar_context;
pub mod recognition;
mod route;
pub mod scan_context;
mod settings;
pub mod spatial;
#[cfg(feature = "cli")]
pub mod stage;
mod submap;
pub mod tf_idf;
pub mod velodyne;
pub mod vocabulary;
mod words;

pub use route::Routes;
pub use settings::Settings;
pub use submap::Submaps;
pub use words::Words;

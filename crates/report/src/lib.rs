//! Tables and figures of experiments.
//!
//! - [`results`]: the JSON results that `posecut-evaluate` wrote, wherever they lie.
//! - [`table`]: methods against sessions, mean and spread over seeds, beside published figures; as Markdown,
//!   CSV and LaTeX.
//! - [`figure`]: trajectories and optimised graphs, as SVG and PNG.

pub mod figure;
pub mod published;
pub mod results;
pub mod table;

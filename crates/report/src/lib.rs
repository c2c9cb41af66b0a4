//! Tables and figures of experiments.
//!
//! - [`results`]: the JSON results that `posecut-evaluate` wrote, wherever they lie.
//! - [`table`]: methods against sessions, mean and spread over seeds, beside published figures; as Markdown,
//!   CSV and LaTeX.
//! - [`regimes`]: where the graph cut helps, is neutral, or hurts, with intervals and tests over seeds.
//! - [`trust`]: what every method gets wrong on every family of graphs, and which one to use.
//! - [`consistency`]: the matrix that PCM decided on.
//! - [`splice`]: tables between the markers of a document.
//! - [`figure`]: all of it drawn, as SVG, PDF and PNG.
//! - [`page`]: all of it as one HTML page.

pub mod consistency;
pub mod figure;
pub mod page;
pub mod published;
pub mod regimes;
pub mod results;
pub mod splice;
pub mod table;
pub mod trust;

//! Tables and figures of experiments.
//!
//! - [`results`]: reads the JSON results of `posecut-evaluate`.
//! - [`table`]: methods by sessions, mean and standard deviation over seeds, beside published figures; as Markdown, CSV
//!   and LaTeX.
//! - [`regimes`]: where the graph cut helps, is neutral, or hurts, with intervals and tests over seeds.
//! - [`trust`]: what every method gets wrong on every family of graphs, and which one to use.
//! - [`consistency`]: PCM's consistency matrix.
//! - [`splice`]: replaces tables between the markers of a document.
//! - [`figure`]: figures as SVG, PDF and PNG.
//! - [`page`]: all tables and figures in one HTML page.

pub mod cli;
pub mod consistency;
pub mod figure;
pub mod page;
pub mod published;
pub mod regimes;
pub mod results;
pub mod splice;
pub mod table;
mod task;
pub mod trust;

//! One self-contained HTML page of an experiment. All data and scripts are in the file; it loads nothing from the
//! network. The same inputs give the same bytes.
//!
//! - [`collect`]: collects the page's data from results and from the graphs in the same folders.
//! - [`view`]: the data in the form that the page's scripts read.
//! - [`maps`]: draws the maps of laser logs.
//! - [`tables`], [`trust`], [`history`]: the parts of the page that are HTML.
//! - [`document`]: assembles the page.
//!
//! What it shares with the page of one graph is in [`posecut_view`]: numbers as short text, escaping, scripts.

pub mod collect;
pub mod document;
pub mod history;
pub mod maps;
pub mod tables;
pub mod trust;
pub mod view;

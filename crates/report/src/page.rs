//! One self-contained HTML page of an experiment. All data and scripts are in the file; it loads nothing from the
//! network. The same inputs give the same bytes.
//!
//! - [`collect`]: collects the page's data from results and from the graphs in the same folders.
//! - [`view`]: the data in the form that the page's scripts read.
//! - [`encode`]: encodes numbers as short text.
//! - [`tables`], [`trust`], [`history`]: the parts of the page that are HTML.
//! - [`document`]: assembles the page.

pub mod collect;
pub mod document;
pub mod encode;
pub mod history;
pub mod markup;
pub mod tables;
pub mod trust;
pub mod view;

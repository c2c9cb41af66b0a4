//! One self-contained HTML page of an experiment: no network, no fonts or scripts from elsewhere; all data and
//! scripts are in the file. The same inputs give the same bytes.
//!
//! - [`collect`]: results and the graphs that lie beside them, as the page's data.
//! - [`view`]: that data, as the page's scripts read it.
//! - [`encode`]: numbers as short text.
//! - [`tables`], [`trust`], [`history`]: what stands in the page as HTML.
//! - [`document`]: the page.

pub mod collect;
pub mod document;
pub mod encode;
pub mod history;
pub mod markup;
pub mod tables;
pub mod trust;
pub mod view;

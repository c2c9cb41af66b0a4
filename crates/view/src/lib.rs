//! One HTML page of a pose graph: which landmark edges (loop closures) are in use, which stage rejected the others, and why. It
//! needs no ground truth. All data and scripts are in the page; it loads nothing from the network. The same inputs give the
//! same bytes.
//!
//! ```
//! use posecut_graph::PoseGraph;
//! use posecut_view::{View, page};
//!
//! let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
//! {"kind":"node","id":0,"pose":[0,0,0]}
//! {"kind":"node","id":1,"pose":[1,0,0]}
//! {"kind":"landmark","id":0,"from":0,"to":1,"rejected_by":"pcm"}
//! "#;
//! let graph = PoseGraph::read("example", text.as_bytes()).unwrap();
//! assert!(page(&View::of(&graph)).unwrap().contains("rejected by pcm"));
//! ```
//!
//! - [`View`]: what a page shows; [`page`] makes it.
//! - [`encode`], [`markup`], [`script`], [`arguments`]: what other pages share with it.

pub mod arguments;
mod broken;
mod chains;
#[cfg(feature = "cli")]
pub mod cli;
mod columns;
mod doubts;
pub mod encode;
mod frame;
mod history;
mod map;
pub mod markup;
mod nodes;
mod page;
mod parts;
mod poses;
mod reckoning;
mod residuals;
pub mod script;
mod states;
mod verification;
mod view;

pub use frame::Frame;
pub use page::page;
pub use states::{Kind, Summary, kind, summary};
pub use view::{Alternative, Remark, Severity, View};

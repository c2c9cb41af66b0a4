//! Inspects pose graphs: summarises a graph ([`info`]), checks whether it is sound ([`validate`]), compares two
//! ([`difference`]), lists the landmark edges ([`edges`]), and extracts a part of a graph ([`filter`]).
//!
//! ```
//! use posecut_graph::PoseGraph;
//! let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
//! {"kind":"node","id":0,"pose":[0,0,0]}
//! {"kind":"node","id":1,"pose":[4,3,0]}
//! "#;
//! let graph = PoseGraph::read("example", text.as_bytes()).unwrap();
//! let info = posecut_inspect::info::Info::of(&graph);
//! assert_eq!((info.nodes, info.components.count), (2, 2));
//! ```

pub mod cli;
pub mod difference;
pub mod edges;
pub mod filter;
pub mod info;
pub mod parts;
pub mod validate;

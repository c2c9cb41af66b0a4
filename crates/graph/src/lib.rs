//! Pose-graph JSON Lines, version 1: the one file format that all posecut stages read and write.
//!
//! A file is a header line, then nodes, then edges, then priors, one JSON object per line, each with a `"kind"`.
//! Poses are `[x, y, theta]` (dimension 2) or `[x, y, z, qx, qy, qz, qw]` (dimension 3), in metres and
//! radians; `information` is the row-major upper triangle of the information matrix (6 or 21 terms) in
//! the order translation, rotation, and weighs `Log(measurement^-1 * (X_from^-1 * X_to))`.
//!
//! This crate promises: numbers survive reading and writing bit for bit; records of unknown kind and
//! unknown fields of known records pass through unchanged; impossible content is refused with file, line,
//! record and field ([`ReadError`]); a file is written in one canonical form.
//!
//! ```
//! let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
//! {"kind":"node","id":0,"pose":[0,0,0]}
//! {"kind":"node","id":1,"pose":[1,0,0],"mood":"fine"}
//! {"kind":"odometry","id":0,"from":0,"to":1,"measurement":[1,0,0],"information":[100,0,0,100,0,400]}
//! "#;
//! let graph = posecut_graph::PoseGraph::read("example", text.as_bytes()).unwrap();
//! assert_eq!(graph.nodes.len(), 2);
//! let mut bytes = Vec::new();
//! graph.write(&mut bytes).unwrap();
//! assert!(String::from_utf8(bytes).unwrap().contains(r#""mood":"fine""#));
//! ```

pub mod connectivity;
mod content;
mod definiteness;
mod dimension;
mod error;
mod expansion;
mod graph;
mod header;
mod lines;
mod parse;
mod prior;
mod read;
mod record;
mod schema;
mod typed;
mod validate;
mod write;

pub use content::Content;
pub use definiteness::{negative_eigenvalue, negative_eigenvalue_of_position};
pub use dimension::Dimension;
pub use error::{FormatProblem, ReadError, WriteError};
pub use expansion::Expansion;
pub use graph::PoseGraph;
pub use header::{Header, InputDigest, NoiseModel, Provenance, StageDoubt, doubts_of};
pub use lines::bounded_lines;
pub use prior::{Prior, PriorOf};
pub use read::{Examination, LONGEST_LINE, RecordReader, examine};
pub use record::{Edge, EdgeKind, EdgeTruth, FIXED, Node, NodeTruth, Record};
pub use schema::schema;
pub use typed::UnusableField;

// `for_dimension!` names these groups.
pub use posecut_geometry::{SE2, SE3};

/// The fields this crate does not know, in the order read.
pub type Extra = serde_json::Map<String, serde_json::Value>;

/// The name of the format, as in the header.
pub const FORMAT: &str = "posecut";

/// The version of the format that this crate reads and writes.
pub const VERSION: u64 = 1;

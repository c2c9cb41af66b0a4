//! What the maintainers' program shares with the tests of the contract, and the sections of documents that it writes.

pub mod documentation;
pub mod sections;
/// The same source as in posecut-report: that crate draws figures, which takes minutes to compile.
#[path = "../../report/src/splice.rs"]
pub mod splice;
pub mod workspace;

//! The parts of the maintainers' program that the tests of the contract use too, and the sections of documents.

pub mod documentation;
pub mod sections;
/// The same source file as in posecut-report. Depending on that crate would compile its figures, which takes minutes.
#[path = "../../report/src/splice.rs"]
pub mod splice;
pub mod workspace;

//! Hostile input for every reader and stage.
//!
//! A [`Target`] reads bytes and returns an [`Outcome`]: a description of what it read, or the sentence with which it refused
//! the input. It must not panic or use memory that the size of the input does not justify, and it must keep its laws
//! (for example, what is read can be written and reads back the same). A [`Campaign`] mutates a target's seeds and keeps
//! every input with a new outcome. The wording of a refusal shows which line of the reader was reached, so outcomes serve as
//! coverage without instrumentation. The same seed gives the same inputs on every machine, so target, seed and number
//! identify a finding.

mod campaign;
mod mutation;
mod seeds;
mod target;

pub use campaign::{Campaign, Finding};
pub use mutation::mutate;
pub use target::{Outcome, TARGETS, Target};

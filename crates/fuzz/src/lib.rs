//! Hostile input for every reader and stage.
//!
//! A [`Target`] reads bytes and answers with an [`Outcome`]: what it made of them, or the sentence with which it refused
//! them. It must not panic, must not take memory that the size of the input does not justify, and must keep the laws
//! written into it (what is read can be written and reads back the same). A [`Campaign`] mutates a target's seeds, and
//! keeps what leads to an outcome it has not seen: the wording of a refusal tells which line of the reader was reached,
//! which serves as coverage without instrumenting anything. The same seed gives the same inputs on every machine, so a
//! finding is named by target, seed and number.

mod campaign;
mod mutation;
mod seeds;
mod target;

pub use campaign::{Campaign, Finding};
pub use mutation::mutate;
pub use target::{Outcome, TARGETS, Target};

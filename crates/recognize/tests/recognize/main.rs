//! Tests of place recognition: laws of its parts, and simulated logs.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod appearance;
mod hypotheses;
mod keys;
mod logs;
mod nclt;
mod places;
mod space;
mod words;

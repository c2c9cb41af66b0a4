//! The tests of the contract. They are one program, so that they share the samples and run in parallel.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bad_input;
mod blindness;
mod certificates;
mod colliding_outputs;
mod conformance;
mod consistency_shown;
mod documentation;
mod doubtful_inputs;
mod doubts;
mod environment;
mod examples;
mod failing_calls;
mod golden;
mod help_and_usage;
mod hostile;
mod inputs_survive;
mod interruption;
mod lasers;
mod manifests;
mod metamorphic;
mod priors;
mod readmission;
mod schema;
mod standard_output;
mod table;
mod threads;

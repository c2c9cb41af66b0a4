//! The tests of the contract, in one program: they share the samples, and the slow ones run beside the others.

mod bad_input;
mod blindness;
mod colliding_outputs;
mod conformance;
mod consistency_shown;
mod documentation;
mod golden;
mod hostile;
mod interruption;
mod manifests;
mod schema;
mod table;

//! The tests of the contract, in one program: they share the samples, and the slow ones run beside the others.

mod bad_input;
mod blindness;
mod colliding_outputs;
mod conformance;
mod consistency_shown;
mod documentation;
mod doubtful_inputs;
mod doubts;
mod environment;
mod failing_calls;
mod golden;
mod help_and_usage;
mod hostile;
mod inputs_survive;
mod interruption;
mod manifests;
mod schema;
mod standard_output;
mod table;
mod threads;

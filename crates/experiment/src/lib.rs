//! Experiments as declarations. A declaration says which stages run, in which order and with which arguments, over which
//! sessions, seeds and parameters, and which results are expected.
//!
//! A declaration ([`Experiment`]) and the stage programs ([`Programs`]) expand to a [`Plan`]: a list of tasks,
//! each one call of a stage program with its inputs, outputs and digest. [`run`] executes a plan on several
//! threads, resumes where an earlier run stopped and never runs a finished task again. For other engines, a plan can
//! be written as JSON Lines or as rules for Make. [`collect()`] collects the results, and [`check`] compares them with
//! expectations.

mod append;
mod call;
pub mod check;
pub mod cli;
mod collect;
mod command;
mod declaration;
mod digest;
mod drawn;
mod expected;
mod fingerprint;
mod graphs;
mod halves;
mod held;
mod items;
mod journal;
mod junit;
mod lock;
mod make_rules;
mod measure;
mod names;
mod parameters;
mod plan;
mod planner;
mod programs;
mod run;
mod schedule;
mod selection;
mod size;
mod times;
mod toml_text;

pub use collect::{Collected, collect};
pub use declaration::{Experiment, Grid, Keep, Origin, Step};
pub use drawn::Drawn;
pub use expected::{Close, Expected, Order, Recorded, Tolerance};
pub use fingerprint::Fingerprint;
pub use graphs::Graphs;
pub use halves::{Half, Halves};
pub use items::members;
pub use junit::junit;
pub use make_rules::make_rules;
pub use measure::{Measured, measure};
pub use parameters::Point;
pub use plan::{Plan, Task};
pub use planner::{Source, plan};
pub use programs::Programs;
pub use run::{RunOptions, Summary, run};
pub use selection::Selection;

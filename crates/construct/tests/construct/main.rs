//! The tests of construction, in one program.

#[path = "../rounds/mod.rs"]
mod rounds;

mod construction;
mod hard_cases;
mod leaks;
mod matches;
mod mistakes;

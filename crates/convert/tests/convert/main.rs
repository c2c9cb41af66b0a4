//! The tests of conversions, in one program.

mod evo;
mod hostile_lines;
mod round_trip;
mod several_files;
mod toro;

//! The tests of conversions, in one program.

mod evo;
mod round_trip;
mod several_files;
mod toro;

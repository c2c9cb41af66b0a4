//! The subcommands of the program, one module for each kind of output.

pub(crate) mod figures;
pub(crate) mod html;
pub(crate) mod regimes;
pub(crate) mod table;
pub(crate) mod trust;

//! What the program can be asked for, one module a kind of answer.

pub(crate) mod figures;
pub(crate) mod html;
pub(crate) mod regimes;
pub(crate) mod table;
pub(crate) mod trust;

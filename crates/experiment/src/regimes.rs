//! Tables of a sweep over covariance scale, share and kind of incorrect edges.

mod sample;
mod sections;

pub use sample::{Interval, Record, Samples};
pub use sections::{Section, section};

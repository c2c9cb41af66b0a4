//! Logs of the Carnegie Mellon Robot Navigation Toolkit (CARMEN; Montemerlo, Roy, Thrun, IROS 2003): planar laser scans with the
//! odometry of their moments.
//!
//! [`expanded`] decompresses, [`Log::read`] parses and repairs, [`Session::of_log`] chooses keyframes and builds the pose graph of a
//! session with a scan at each keyframe. With [`LogOptions::scan_matching`] the steps between keyframes are refined by ICP.
//!
//! Lengths are metres, angles radians, times microseconds. Everything is deterministic and runs on one thread.

mod error;
mod expand;
pub mod keyframes;
mod line;
mod log;
pub mod noise;
mod options;
mod session;
mod trajectory;
mod write;

pub use error::LogError;
pub use expand::{expanded, looks_like_log};
pub use log::{Log, LoggedScan, Repairs};
pub use options::LogOptions;
pub use session::{Session, Summary, session_name};
pub use trajectory::{trajectory, write_trajectory};
pub use write::{seconds, write_scan};

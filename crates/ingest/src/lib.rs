//! Reads the files of an NCLT session (Carlevaris-Bianco, Ushani, Eustice, IJRR 35(9), 2016) and builds the pose graph
//! of the session: keyframes down-sampled from the camera's clock, odometry edges with covariances, and ground truth at
//! the keyframes, with laser scans if the session has `hokuyo_30m.bin`.
//!
//! NCLT's frames are kept: the local frame has x north, y east, z down; the body x forward, y right,
//! z down; `R = Rz(yaw) Ry(pitch) Rx(roll)`. Lengths are metres, angles radians, times microseconds UTC.
//!
//! [`ingest`] reports files, choices and warnings as [`Event`]s; the program turns them into progress, digests and
//! messages.

mod assemble;
#[cfg(feature = "cli")]
pub mod cli;
mod clock;
mod covariance;
mod distance_factor;
mod error;
mod event;
mod frozen;
mod gps;
mod laser;
mod nees;
mod odometry;
mod options;
mod scan_matching;
mod session;
mod summary;
mod table;
mod trajectory;

pub use assemble::{Ingested, ingest};
pub use clock::{ClockSource, keyframe_times};
pub use distance_factor::DistanceFactor;
pub use error::IngestError;
pub use event::{Choice, Event, Warning};
pub use gps::GpsSource;
pub use laser::Laser;
pub use nees::{Nees, WINDOWS, nees};
pub use odometry::{HeadingSource, OdometrySource};
pub use options::Options;
pub use session::{FileKind, SessionFiles};
pub use summary::{CovarianceSource, StepErrors, Summary};
pub use table::Table;
pub use trajectory::Trajectory;

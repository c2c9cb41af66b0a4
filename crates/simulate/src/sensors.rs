//! Simulates the sensors on a drive, as rows of NCLT's files. The errors are as large as those of the real sensors, as
//! far as the data show them; the crate's README compares both.

mod compass;
mod gps;
mod imu;
mod odometry;
mod truth;
mod wheels;

pub use compass::{euler, fibre_optic_gyro};
pub use gps::gps;
pub use imu::imu;
pub use odometry::{Odometry, odometry};
pub use truth::ground_truth;
pub use wheels::wheels;

/// One row of a file: the time in microseconds, then its numbers.
pub type Row = (i64, Vec<f64>);

/// x, y, z, roll, pitch, yaw of a pose.
pub(crate) fn six(pose: &posecut_geometry::SE3) -> Vec<f64> {
    let (roll, pitch, yaw) = pose.euler();
    vec![pose.translation.x, pose.translation.y, pose.translation.z, roll, pitch, yaw]
}

//! The options for trajectories.

use serde::Serialize;

use super::options::is_default;
use crate::trajectory::Axes;

/// What becomes of a trajectory.
#[derive(Clone, Debug, Default, clap::Args, Serialize)]
pub struct TrajectoryOptions {
    /// Join consecutive poses of each session by odometry edges that measure their relative motion
    #[arg(
        long,
        requires_all = ["sigma_translation", "sigma_rotation"],
        help_heading = "Trajectories"
    )]
    #[serde(skip_serializing_if = "is_default")]
    pub odometry_from_poses: bool,

    /// Set the standard deviation of these edges in translation, metres per axis
    #[arg(long, value_name = "METRES", requires = "odometry_from_poses", help_heading = "Trajectories")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma_translation: Option<f64>,

    /// Set the standard deviation of these edges in rotation, radians per axis
    #[arg(long, value_name = "RADIANS", requires = "odometry_from_poses", help_heading = "Trajectories")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma_rotation: Option<f64>,

    /// Project a trajectory to the plane (2): x, y and the heading about the vertical axis
    #[arg(long, value_name = "2", value_parser = clap::value_parser!(u8).range(2..=2), help_heading = "Trajectories")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dimension: Option<u8>,

    /// Project poses with these axes [default: camera for KITTI, robot otherwise]
    #[arg(long, value_enum, requires = "dimension", help_heading = "Trajectories")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<Axes>,

    /// Project a trajectory even if it is not near a plane
    #[arg(long, requires = "dimension", help_heading = "Trajectories")]
    #[serde(skip_serializing_if = "is_default")]
    pub flatten: bool,
}

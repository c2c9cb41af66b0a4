//! The options of reading a log.

use serde::Serialize;

use crate::LogError;

/// How a log becomes a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct LogOptions {
    /// Make a keyframe whenever the robot has moved by this distance, metres
    #[cfg_attr(feature = "cli", arg(long, help_heading = "CARMEN logs", value_name = "METRES", default_value_t = LogOptions::DEFAULT.keyframe_distance))]
    pub keyframe_distance: f64,

    /// Make a keyframe whenever the robot has turned by this angle, radians
    #[cfg_attr(feature = "cli", arg(long, help_heading = "CARMEN logs", value_name = "RADIANS", default_value_t = LogOptions::DEFAULT.keyframe_angle))]
    pub keyframe_angle: f64,

    /// Treat ranges from this value on as beams without a return, metres
    #[cfg_attr(feature = "cli", arg(long, help_heading = "CARMEN logs", value_name = "METRES", default_value_t = LogOptions::DEFAULT.max_range))]
    pub max_range: f64,

    /// Set the field of view of the scanner, degrees, for FLASER lines; ROBOTLASER1 lines have their own
    #[cfg_attr(feature = "cli", arg(long, help_heading = "CARMEN logs", value_name = "DEGREES", default_value_t = LogOptions::DEFAULT.field_of_view))]
    pub field_of_view: f64,

    /// Refine the odometry by matching the scans of successive keyframes. Whoever reads more than logs has a flag of its own for it.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub scan_matching: bool,
}

impl Default for LogOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl LogOptions {
    /// A keyframe every half metre or half radian; the odometry as it is.
    pub const DEFAULT: Self = Self {
        keyframe_distance: 0.5,
        keyframe_angle: 0.5,
        max_range: 50.0,
        field_of_view: 180.0,
        scan_matching: false,
    };

    /// Refuses meaningless numbers.
    pub fn check(&self) -> Result<(), LogError> {
        let refuse = |option, value, expected| Err(LogError::Option { option, value, expected });
        for (option, value) in [
            ("--keyframe-distance", self.keyframe_distance),
            ("--keyframe-angle", self.keyframe_angle),
            ("--max-range", self.max_range),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return refuse(option, value, "a positive number");
            }
        }
        if !(self.field_of_view > 0.0 && self.field_of_view <= 360.0) {
            return refuse("--field-of-view", self.field_of_view, "above 0 and at most 360 degrees");
        }
        Ok(())
    }
}

//! The options of ingestion.

use serde::Serialize;

use crate::{GpsSource, HeadingSource, IngestError, OdometrySource};

/// What shapes the session's graph.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Options {
    /// Set the session's name in the graph [default: its date]
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME"))]
    pub name: Option<String>,

    /// Write poses in the ground plane (2: x north, y east, heading) or in space (3: six degrees of freedom)
    #[cfg_attr(feature = "cli", arg(long, value_name = "2|3", default_value_t = Options::DEFAULT.dimension, value_parser = clap::value_parser!(u64).range(2..=3)))]
    pub dimension: u64,

    /// Choose the source of the odometry
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.odometry, help_heading = "Odometry"))]
    pub odometry: OdometrySource,

    /// Choose the source of the heading for odometry from the wheels
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.heading, help_heading = "Odometry"))]
    pub heading: HeadingSource,

    /// Multiply the distances that the odometry reports by this factor, whatever its source.
    ///
    /// For example, 0.93 corrects wheels that over-read by 7 %, as NCLT's do, and 1.07 makes exact odometry over-read by
    /// 7 %.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FACTOR", default_value_t = Options::DEFAULT.wheel_scale, help_heading = "Odometry"))]
    pub wheel_scale: f64,

    /// Set the standard deviation of each translation axis, metres per keyframe step, instead of reading odometry_cov*.csv
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", help_heading = "Odometry"))]
    pub sigma_translation: Option<f64>,

    /// Set the standard deviation of each rotation axis, radians per keyframe step, instead of reading odometry_cov*.csv
    #[cfg_attr(feature = "cli", arg(long, value_name = "RADIANS", help_heading = "Odometry"))]
    pub sigma_rotation: Option<f64>,

    /// Refine the steps between keyframes by matching their laser scans. The command line has one flag for sessions and logs.
    #[cfg_attr(feature = "cli", arg(skip))]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub scan_matching: bool,

    /// Write GPS as priors of positions in the local frame of the ground truth: for each keyframe the nearest fix within 0.5 s
    #[cfg_attr(feature = "cli", arg(long, value_enum, value_name = "RECEIVER", help_heading = "GPS"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gps: Option<GpsSource>,

    /// Set the standard deviation of GPS, metres per axis [default by fix mode: gps 5 with altitude and 15 without, rtk 1 and 5]
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", requires = "gps", help_heading = "GPS"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma_gps: Option<f64>,

    /// Keep every N-th image as a keyframe (the paper's 10 reduces 5 Hz to 0.5 Hz)
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Options::DEFAULT.keep_every, value_parser = clap::value_parser!(u32).range(1..), help_heading = "Keyframes"))]
    pub keep_every: u32,

    /// Set the time between images, seconds, for sessions with neither images nor odometry_mu.csv
    #[cfg_attr(feature = "cli", arg(long, value_name = "SECONDS", default_value_t = Options::DEFAULT.period, help_heading = "Keyframes"))]
    pub period: f64,

    /// Treat a longer silence of a sensor than this as a gap, seconds; nothing is interpolated across a gap
    #[cfg_attr(feature = "cli", arg(long, value_name = "SECONDS", default_value_t = Options::DEFAULT.longest_silence, help_heading = "Keyframes"))]
    pub longest_silence: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options {
    /// A planar graph of every tenth image, from the first source that the session has.
    pub const DEFAULT: Self = Self {
        name: None,
        dimension: 2,
        odometry: OdometrySource::Auto,
        heading: HeadingSource::Auto,
        wheel_scale: 1.0,
        sigma_translation: None,
        sigma_rotation: None,
        scan_matching: false,
        gps: None,
        sigma_gps: None,
        keep_every: 10,
        period: 0.2,
        longest_silence: 5.0,
    };

    /// Default standard deviations without a covariance file: metres and radians per keyframe step.
    pub const DEFAULT_SIGMA: (f64, f64) = (0.1, 0.02);

    /// Refuses meaningless numbers.
    pub fn check(&self) -> Result<(), IngestError> {
        let positive = [
            ("--wheel-scale", Some(self.wheel_scale)),
            ("--sigma-translation", self.sigma_translation),
            ("--sigma-rotation", self.sigma_rotation),
            ("--sigma-gps", self.sigma_gps),
            ("--period", Some(self.period)),
            ("--longest-silence", Some(self.longest_silence)),
        ];
        for (option, value) in positive {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return Err(IngestError::Option { option, value });
            }
        }
        Ok(())
    }
}

//! The options of construction. Their defaults are this project's reading of the paper.

use serde::Serialize;

use crate::{ConstructError, IncorrectKind, MatchMeasurement, NoiseKind};

/// Whether sessions are split into two experiences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Split {
    /// A single session at its middle; several sessions stay whole
    Auto,
    /// Every session at its middle keyframe
    Middle,
    /// No session
    None,
}

impl Split {
    pub(crate) fn applies(self, sessions: usize) -> bool {
        match self {
            Self::Auto => sessions == 1,
            Self::Middle => true,
            Self::None => false,
        }
    }
}

/// What shapes the multi-session graph.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Options {
    /// Choose which sessions are split into two experiences, /a and /b
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.split))]
    pub split: Split,

    /// Join viewpoints up to this distance apart, metres
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Options::DEFAULT.radius, help_heading = "Correct landmark edges"))]
    pub radius: f64,

    /// Join viewpoints whose headings differ by at most this angle, degrees
    #[cfg_attr(feature = "cli", arg(long, value_name = "DEGREES", default_value_t = Options::DEFAULT.heading, help_heading = "Correct landmark edges"))]
    pub heading: f64,

    /// Join viewpoints at least this time apart, seconds
    #[cfg_attr(feature = "cli", arg(long, value_name = "SECONDS", default_value_t = Options::DEFAULT.minimum_interval, help_heading = "Correct landmark edges"))]
    pub minimum_interval: f64,

    /// Set the standard deviation of landmark edges in translation, metres per axis
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Options::DEFAULT.landmark_sigma_translation, help_heading = "Correct landmark edges"))]
    pub landmark_sigma_translation: f64,

    /// Set the standard deviation of landmark edges in rotation, radians per axis
    #[cfg_attr(feature = "cli", arg(long, value_name = "RADIANS", default_value_t = Options::DEFAULT.landmark_sigma_rotation, help_heading = "Correct landmark edges"))]
    pub landmark_sigma_rotation: f64,

    /// Choose the distribution of the noise of landmark edges, correct and incorrect
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.noise, help_heading = "Correct landmark edges"))]
    pub noise: NoiseKind,

    /// Multiply the covariance that landmark edges state by this factor, without changing their noise
    #[cfg_attr(feature = "cli", arg(long, value_name = "FACTOR", default_value_t = Options::DEFAULT.landmark_covariance_scale, help_heading = "Correct landmark edges"))]
    pub landmark_covariance_scale: f64,

    /// Also join viewpoints of opposite heading, within --radius and --heading
    #[cfg_attr(feature = "cli", arg(long, help_heading = "Correct landmark edges"))]
    pub opposite_direction: bool,

    /// Keep this many correct edges, drawn at random [default: all]
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", help_heading = "Correct landmark edges"))]
    pub correct_edges: Option<usize>,

    /// Remove all correct edges after the incorrect ones are drawn, as if the experiences did not overlap
    #[cfg_attr(
        feature = "cli",
        arg(long, conflicts_with = "correct_edges", help_heading = "Correct landmark edges")
    )]
    pub no_correct_edges: bool,

    /// Remove this many odometry edges, drawn at random, so that sessions fall into several chains
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Options::DEFAULT.odometry_gaps, help_heading = "Odometry"))]
    pub odometry_gaps: usize,

    /// Set the share of incorrect edges among all landmark edges, from 0 to below 1
    #[cfg_attr(feature = "cli", arg(long, value_name = "RATE", default_value_t = Options::DEFAULT.incorrect_rate, help_heading = "Incorrect landmark edges"))]
    pub incorrect_rate: f64,

    /// Choose how incorrect edges arise
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.incorrect_kind, help_heading = "Incorrect landmark edges"))]
    pub incorrect_kind: IncorrectKind,

    /// Match stretches of this many viewpoints (`--incorrect-kind grouped`)
    #[cfg_attr(feature = "cli", arg(long, value_name = "VIEWPOINTS", default_value_t = Options::DEFAULT.group_length, help_heading = "Incorrect landmark edges"))]
    pub group_length: usize,

    /// Join viewpoints farther apart than this by incorrect edges, metres; by near misses, viewpoints within it
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Options::DEFAULT.incorrect_distance, help_heading = "Incorrect landmark edges"))]
    pub incorrect_distance: f64,

    /// Choose the measurement of the edges of --matches
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.match_measurement, help_heading = "Landmark edges from a list"))]
    pub match_measurement: MatchMeasurement,

    /// Set the seed of all random numbers
    #[cfg_attr(feature = "cli", arg(long, value_name = "SEED", default_value_t = Options::DEFAULT.seed))]
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options {
    /// This project's reading of the paper.
    pub const DEFAULT: Self = Self {
        split: Split::Auto,
        radius: 3.0,
        heading: 30.0,
        minimum_interval: 0.0,
        landmark_sigma_translation: 0.1,
        landmark_sigma_rotation: 0.02,
        noise: NoiseKind::Gaussian,
        landmark_covariance_scale: 1.0,
        opposite_direction: false,
        correct_edges: None,
        no_correct_edges: false,
        odometry_gaps: 0,
        incorrect_rate: 0.0,
        incorrect_kind: IncorrectKind::Uniform,
        group_length: 10,
        incorrect_distance: 10.0,
        match_measurement: MatchMeasurement::None,
        seed: 1,
    };

    /// Refuses meaningless values.
    pub fn check(&self) -> Result<(), ConstructError> {
        let refuse = |option, value, expected| Err(ConstructError::Option { option, value, expected });
        if !(0.0..1.0).contains(&self.incorrect_rate) {
            return refuse("--incorrect-rate", self.incorrect_rate, "at least 0 and below 1");
        }
        for (option, value) in [("--radius", self.radius), ("--heading", self.heading)] {
            if !(value > 0.0 && value.is_finite()) {
                return refuse(option, value, "a positive number");
            }
        }
        let squared = [
            ("--landmark-sigma-translation", self.landmark_sigma_translation),
            ("--landmark-sigma-rotation", self.landmark_sigma_rotation),
            ("--landmark-covariance-scale", self.landmark_covariance_scale),
        ];
        for (option, value) in squared {
            // The information is one over the square of this value, and both must be finite.
            if !(1e-50..=1e50).contains(&value) {
                return refuse(option, value, "a positive number, from 1e-50 to 1e50");
            }
        }
        let not_negative = [
            ("--minimum-interval", self.minimum_interval),
            ("--incorrect-distance", self.incorrect_distance),
        ];
        for (option, value) in not_negative {
            if !(value >= 0.0 && value.is_finite()) {
                return refuse(option, value, "zero or a positive number");
            }
        }
        if self.correct_edges == Some(0) {
            return refuse("--correct-edges", 0.0, "at least 1; use --no-correct-edges for none");
        }
        if let (Some(wanted), true) = (self.correct_edges, self.no_correct_edges) {
            return refuse("--correct-edges", wanted as f64, "left out when --no-correct-edges is given");
        }
        if self.group_length < 2 {
            return refuse(
                "--group-length",
                self.group_length as f64,
                "at least 2, so that its edges support each other",
            );
        }
        if self.incorrect_distance < self.radius {
            return refuse(
                "--incorrect-distance",
                self.incorrect_distance,
                "at least --radius, because nearer pairs are correct edges",
            );
        }
        Ok(())
    }
}

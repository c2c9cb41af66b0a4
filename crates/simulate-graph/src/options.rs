//! The options of simulation: parts of the character that are not to be drawn.

use serde::Serialize;

use crate::{Mistake, World};

/// An option with which no graph can be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{option} is {value}, but must be {expected}")]
pub struct OptionError {
    pub(crate) option: &'static str,
    pub(crate) value: String,
    pub(crate) expected: &'static str,
}

/// What is fixed; everything else is drawn from the seed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Options {
    /// Set the seed of everything that no option fixes
    #[cfg_attr(feature = "cli", arg(long, value_name = "SEED", default_value_t = 1))]
    pub seed: u64,

    /// Simulate in the plane (2) or in space (3) [default: drawn]
    #[cfg_attr(feature = "cli", arg(long, value_name = "2|3", value_parser = clap::value_parser!(u64).range(2..=3)))]
    pub dimension: Option<u64>,

    /// Choose the paths of the robots [default: drawn]
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub world: Option<World>,

    /// Set the number of robots, each a session of its own [default: drawn, 1 to 4]
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000)))]
    pub robots: Option<u32>,

    /// Set the number of poses of each robot, 1 m apart [default: drawn, 150 to 800]
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(50..=1_000_000)))]
    pub poses: Option<u32>,

    /// Set the largest number of correct landmark edges [default: drawn, 20 to 400]
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", help_heading = "Landmark edges"))]
    pub correct_edges: Option<u32>,

    /// Set the share of incorrect edges among all landmark edges, from 0 to below 1 [default: drawn, 0 to 0.8]
    #[cfg_attr(feature = "cli", arg(long, value_name = "RATE", help_heading = "Landmark edges"))]
    pub incorrect_rate: Option<f64>,

    /// Choose how incorrect edges arise, one or several kinds separated by commas [default: drawn]
    #[cfg_attr(
        feature = "cli",
        arg(long, value_enum, value_delimiter = ',', value_name = "KIND", help_heading = "Landmark edges")
    )]
    pub incorrect_kind: Vec<Mistake>,

    /// Set the deviations of odometry, in those that its covariance claims [default: drawn, 0.1 to 8]
    #[cfg_attr(feature = "cli", arg(long, value_name = "FACTOR", help_heading = "Noise"))]
    pub odometry_ratio: Option<f64>,

    /// Set the deviations of correct landmark edges, in those that their covariance claims [default: drawn, 0.3 to 3]
    #[cfg_attr(feature = "cli", arg(long, value_name = "FACTOR", help_heading = "Noise"))]
    pub landmark_ratio: Option<f64>,
}

impl Options {
    /// Refuses options with which no graph can be simulated.
    pub fn check(&self) -> Result<(), OptionError> {
        let refuse = |option, value: String, expected| Err(OptionError { option, value, expected });
        if let Some(rate) = self.incorrect_rate.filter(|rate| !(0.0..1.0).contains(rate)) {
            return refuse("--incorrect-rate", rate.to_string(), "at least 0 and below 1");
        }
        for (option, ratio) in
            [("--odometry-ratio", self.odometry_ratio), ("--landmark-ratio", self.landmark_ratio)]
        {
            if let Some(ratio) = ratio.filter(|ratio| !(0.01..=100.0).contains(ratio)) {
                return refuse(option, ratio.to_string(), "between 0.01 and 100");
            }
        }
        if self.world == Some(World::Flight) && self.dimension == Some(2) {
            return refuse(
                "--world",
                "flight".to_owned(),
                "another one in the plane; flights need --dimension 3",
            );
        }
        Ok(())
    }
}

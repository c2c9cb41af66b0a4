//! The options of simulation.

use serde::Serialize;

/// An option with which no log can be simulated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{option} is {value}, but must be between {least} and {most}")]
pub struct OptionError {
    option: &'static str,
    value: f64,
    least: f64,
    most: f64,
}

/// What shapes a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Options {
    /// Set the seed of the route and of all noise
    #[cfg_attr(feature = "cli", arg(long, value_name = "SEED", default_value_t = Options::DEFAULT.seed))]
    pub seed: u64,

    /// Set the seed of the building; use one building for sessions that meet
    #[cfg_attr(feature = "cli", arg(long, value_name = "SEED", default_value_t = Options::DEFAULT.building))]
    pub building: u64,

    /// Set the number of blocks of rooms along each side of the building
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Options::DEFAULT.blocks, value_parser = clap::value_parser!(u32).range(1..=20)))]
    pub blocks: u32,

    /// Set the length of the drive, metres
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Options::DEFAULT.length))]
    pub length: f64,

    /// Set the standard deviation of ranges, metres
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Options::DEFAULT.range_noise))]
    pub range_noise: f64,

    /// Multiply the slips of the wheels by this factor; 1 is the error model of posecut-ingest, 0 no slip
    #[cfg_attr(feature = "cli", arg(long, value_name = "FACTOR", default_value_t = Options::DEFAULT.slip))]
    pub slip: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options {
    /// A drive of 200 m through two by two blocks.
    pub const DEFAULT: Self =
        Self { seed: 1, building: 1, blocks: 2, length: 200.0, range_noise: 0.01, slip: 1.0 };

    /// Refuses options with which no log can be simulated.
    pub fn check(&self) -> Result<(), OptionError> {
        let ranges = [
            ("--blocks", f64::from(self.blocks), 1.0, 20.0),
            ("--length", self.length, 5.0, 20_000.0),
            ("--range-noise", self.range_noise, 0.0, 1.0),
            ("--slip", self.slip, 0.0, 100.0),
        ];
        match ranges.into_iter().find(|(_, value, least, most)| !(least..=most).contains(&value)) {
            None => Ok(()),
            Some((option, value, least, most)) => Err(OptionError { option, value, least, most }),
        }
    }
}

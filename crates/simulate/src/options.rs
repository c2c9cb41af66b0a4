//! The options of simulation.

use serde::Serialize;

use crate::Route;

/// An option with which no session can be simulated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OptionError {
    /// Too few or too many rows a second.
    #[error("--rate is {0}, and must lie between 5 (the camera's) and 200 Hz")]
    Rate(f64),
    /// A drive that is too short or too long.
    #[error("--length is {0}, and must lie between 50 and 100000 m")]
    Length(f64),
}

/// What shapes a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Options {
    /// Seed of the session: route, drive and all sensors
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Options::DEFAULT.seed))]
    pub seed: u64,

    /// Seed of the campus, which sessions to be compared share
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Options::DEFAULT.campus))]
    pub campus: u64,

    /// Length of the drive, metres; between 5500 and 6100 by the seed unless given
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES"))]
    pub length: Option<f64>,

    /// Which way the robot takes
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.route))]
    pub route: Route,

    /// Rows a second of the fast sensors; NCLT's own rates are 40 to 150, which makes files ten times as large
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ", default_value_t = Options::DEFAULT.rate))]
    pub rate: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options {
    /// The first seeds, a length that the seed determines, and ten rows a second.
    pub const DEFAULT: Self = Self { seed: 1, campus: 1, length: None, route: Route::Wander, rate: 10.0 };

    /// Refuses options with which no session can be simulated.
    pub fn check(&self) -> Result<(), OptionError> {
        if !(5.0..=200.0).contains(&self.rate) {
            return Err(OptionError::Rate(self.rate));
        }
        if let Some(length) = self.length
            && !(50.0..=100_000.0).contains(&length)
        {
            return Err(OptionError::Length(length));
        }
        Ok(())
    }
}

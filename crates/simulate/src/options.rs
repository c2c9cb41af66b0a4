//! The options of simulation.

use serde::Serialize;

use crate::Route;

/// An option with which no session can be simulated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OptionError {
    /// Too few or too many rows a second.
    #[error("--rate is {0}, but must be between 5 (the camera's rate) and 200 Hz")]
    Rate(f64),
    /// A drive that is too short or too long.
    #[error("--length is {0}, but must be between 50 and 100000 m")]
    Length(f64),
    /// Too few or too many scans a second.
    #[error("{0} is {1}, but must be between 0.1 and the {2} Hz of --rate")]
    Scans(&'static str, f64, f64),
}

/// What shapes a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Options {
    /// Set the seed of the session: route, drive and all sensors
    #[cfg_attr(feature = "cli", arg(long, value_name = "SEED", default_value_t = Options::DEFAULT.seed))]
    pub seed: u64,

    /// Set the seed of the campus; use one campus for sessions to be compared
    #[cfg_attr(feature = "cli", arg(long, value_name = "SEED", default_value_t = Options::DEFAULT.campus))]
    pub campus: u64,

    /// Set the length of the drive, metres [default: between 5500 and 6100, by the seed]
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES"))]
    pub length: Option<f64>,

    /// Choose the route of the robot
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.route))]
    pub route: Route,

    /// Set the rate of the fast sensors, Hz.
    ///
    /// NCLT's own rates are 40 to 150 Hz, with files ten times as large.
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ", default_value_t = Options::DEFAULT.rate))]
    pub rate: f64,

    /// Write hokuyo_30m.bin, the scans of a planar laser scanner, at this rate, Hz; the scanner itself has 40 Hz
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ", help_heading = "Laser scanners"))]
    pub hokuyo: Option<f64>,

    /// Write velodyne_sync/UTIME.bin, the hits of a three-dimensional laser scanner, at this rate, Hz; NCLT's has 5 Hz, at the images
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ", help_heading = "Laser scanners"))]
    pub velodyne: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options {
    /// The first seeds, a length that the seed determines, and ten rows a second.
    pub const DEFAULT: Self = Self {
        seed: 1,
        campus: 1,
        length: None,
        route: Route::Wander,
        rate: 10.0,
        hokuyo: None,
        velodyne: None,
    };

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
        for (option, value) in [("--hokuyo", self.hokuyo), ("--velodyne", self.velodyne)] {
            if let Some(value) = value
                && !(0.1..=self.rate).contains(&value)
            {
                return Err(OptionError::Scans(option, value, self.rate));
            }
        }
        Ok(())
    }
}

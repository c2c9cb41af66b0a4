//! The options of PCM.

use std::fmt;
use std::str::FromStr;
use std::time::{Duration, Instant};

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::calibration::{ScaleEstimate, Scales};
use crate::chance::COST;
use crate::clique::Limits;
use crate::{Correction, Gate, PcmError, Test, corrected};

/// The most candidates of a group for which all pairs are tested; their matrix takes 50 MB.
const MOST_EXACT: usize = 20_000;

/// The default number of branch-and-bound nodes for up to a thousand candidates.
const NODES: f64 = 2e7;

/// The same with `--scale auto`. A node costs about N^2 bits, so this is less than a second for any number of candidates. A
/// gate that is an estimate is not worth minutes of proof, and one that is far too wide leaves a gap that no search closes.
const NODES_OF_ESTIMATES: f64 = 1e3;

/// One branch of the root may take one in this many of all nodes.
const STALL: f64 = 20.0;

/// How a group is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// `exact` for up to 20000 candidates between two chains, `cells` for more
    #[default]
    Auto,
    /// Tests of all pairs, then the maximum clique; N candidates take N^2 / 8 bytes
    Exact,
    /// The maximum clique over hypotheses from cells of travelled distance, then growth; memory is linear in N
    Cells,
}

impl Scheme {
    /// `Exact` or `Cells`.
    pub(crate) fn for_candidates(self, candidates: usize) -> Self {
        match self {
            Self::Auto if candidates > MOST_EXACT => Self::Cells,
            Self::Auto => Self::Exact,
            chosen => chosen,
        }
    }
}

/// The factors that multiply the covariances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// These factors.
    Fixed(Scales),
    /// Factors estimated from the data.
    Auto,
}

impl FromStr for Scale {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let factor = |text: &str| text.parse().ok().filter(|&factor| factor > 0.0 && f64::is_finite(factor));
        let (odometry, landmark) = text.split_once(',').unwrap_or((text, text));
        match (factor(odometry), factor(landmark)) {
            (Some(odometry), Some(landmark)) => Ok(Self::Fixed(Scales { odometry, landmark })),
            _ => Err("expected `auto`, a positive number, or two: ODOMETRY,LANDMARK".to_owned()),
        }
    }
}

impl fmt::Display for Scale {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(Scales { odometry, landmark }) if odometry == landmark => {
                write!(formatter, "{odometry}")
            }
            Self::Fixed(Scales { odometry, landmark }) => write!(formatter, "{odometry},{landmark}"),
            Self::Auto => formatter.write_str("auto"),
        }
    }
}

impl Serialize for Scale {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Fixed(Scales { odometry, landmark }) if odometry == landmark => {
                serializer.serialize_f64(*odometry)
            }
            Self::Fixed(Scales { odometry, landmark }) => [odometry, landmark].serialize(serializer),
            Self::Auto => serializer.serialize_str("auto"),
        }
    }
}

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Word(String),
            One(f64),
            Two([f64; 2]),
        }
        let text = match Written::deserialize(deserializer)? {
            Written::Word(word) => word,
            Written::One(factor) => factor.to_string(),
            Written::Two([odometry, landmark]) => format!("{odometry},{landmark}"),
        };
        text.parse().map_err(D::Error::custom)
    }
}

/// The options of PCM. From the history of a graph they are read back with defaults for what it does not say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default)]
pub struct Options {
    /// Choose the test of whether two edges are consistent
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.test))]
    pub test: Test,

    /// Set the probability that correct edges pass the test
    #[cfg_attr(feature = "cli", arg(long, value_name = "P", default_value_t = Options::DEFAULT.probability))]
    pub probability: f64,

    /// Choose what the probability refers to
    #[cfg_attr(feature = "cli", arg(long, value_enum, value_name = "WHAT", default_value_t = Options::DEFAULT.correction))]
    pub correction: Correction,

    /// Accept loops up to this translation error, metres per step (`--test threshold`)
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Options::DEFAULT.translation_per_step))]
    pub translation_per_step: f64,

    /// Accept loops up to this rotation error, radians per step (`--test threshold`)
    #[cfg_attr(feature = "cli", arg(long, value_name = "RADIANS", default_value_t = Options::DEFAULT.rotation_per_step))]
    pub rotation_per_step: f64,

    /// Multiply all covariances by FACTOR, or by two factors, ODOMETRY,LANDMARK; `auto` estimates both from loops.
    ///
    /// For example, `--scale 0.5,2` halves the covariances of odometry edges and doubles those of landmark edges.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FACTOR", default_value_t = Options::DEFAULT.scale))]
    pub scale: Scale,

    /// Rescale the information matrices in the output by the estimated covariance scales
    #[cfg_attr(feature = "cli", arg(long))]
    pub calibrate: bool,

    /// Skip the odometry-only test of edges within one chain
    #[cfg_attr(feature = "cli", arg(long))]
    pub no_odometry_test: bool,

    /// Also keep candidates outside the clique that agree, at this probability, with three quarters of the members near them
    #[cfg_attr(feature = "cli", arg(long, value_name = "P"))]
    pub grow: Option<f64>,

    /// Reject edges that agree by chance alone, where a wrong edge costs as much as COST correct ones [default: 3 for grown edges and --scheme cells, otherwise no such test]
    #[cfg_attr(feature = "cli", arg(long, value_name = "COST"))]
    pub chance: Option<f64>,

    /// Choose how each group of candidates is solved
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t = Options::DEFAULT.scheme, help_heading = "Search"))]
    pub scheme: Scheme,

    /// Set the side of a cell, metres travelled (`--scheme cells`)
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Options::DEFAULT.cell_size, help_heading = "Search"))]
    pub cell_size: f64,

    /// Stop the search after this many branch-and-bound nodes in all groups together, and keep the largest cliques found [default: 2e7, times (1000/N)^2 above 1000 candidates; with --scale auto 1e3 (1000/N)^2].
    ///
    /// Each group gets a share in proportion to its squared number of candidates; later groups use what earlier ones leave.
    /// Without this option, a search also stops when its bound stalls: when a twentieth of the nodes brings no progress.
    #[cfg_attr(feature = "cli", arg(long, value_name = "NODES", help_heading = "Search"))]
    pub work_limit: Option<u64>,

    /// Stop all searches after this many seconds; the result then depends on the machine
    #[cfg_attr(feature = "cli", arg(long, value_name = "SECONDS", help_heading = "Search"))]
    pub time_limit: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options {
    /// The options of the paper.
    pub const DEFAULT: Self = Self {
        test: Test::Mahalanobis,
        probability: 0.99,
        correction: Correction::Pair,
        translation_per_step: 0.01,
        rotation_per_step: 0.001,
        scale: Scale::Fixed(Scales::ONE),
        calibrate: false,
        no_odometry_test: false,
        grow: None,
        chance: None,
        scheme: Scheme::Auto,
        cell_size: 10.0,
        work_limit: None,
        time_limit: None,
    };

    /// Rejects numbers outside the valid ranges.
    pub(crate) fn check(&self) -> Result<(), PcmError> {
        for (option, value) in [
            ("--translation-per-step", self.translation_per_step),
            ("--rotation-per-step", self.rotation_per_step),
            ("--cell-size", self.cell_size),
            ("--time-limit", self.time_limit.unwrap_or(1.0)),
            ("--chance", self.cost()),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(PcmError::NotPositive { option, value });
            }
        }
        if self.test == Test::Threshold {
            for (option, used) in [
                ("--scale", self.scale != Scale::Fixed(Scales::ONE)),
                ("--calibrate", self.calibrate),
                ("--chance", self.chance.is_some()),
            ] {
                if used {
                    return Err(PcmError::CovariancesUnread { option });
                }
            }
        }
        Ok(())
    }

    /// The gate for a group of this many candidates.
    pub(crate) fn gate(
        &self,
        probability: f64,
        candidates: usize,
        degrees_of_freedom: usize,
    ) -> Result<Gate, PcmError> {
        let probability = corrected(probability, self.correction, candidates);
        if self.test == Test::Threshold {
            return Ok(Gate::per_step(self.translation_per_step, self.rotation_per_step));
        }
        Gate::new(self.test, probability, degrees_of_freedom)
    }

    /// Whether the scales of covariances are to be estimated.
    pub(crate) fn wants_estimate(&self) -> bool {
        self.calibrate || self.scale == Scale::Auto
    }

    /// The scales to apply, given the estimate.
    pub(crate) fn scales(&self, estimate: Option<ScaleEstimate>) -> Scales {
        match self.scale {
            Scale::Fixed(scales) => scales,
            Scale::Auto => estimate.map_or(Scales::ONE, |estimate| estimate.scales),
        }
    }

    /// The cost of a wrong edge where edges may agree by chance.
    pub(crate) fn cost(&self) -> f64 {
        self.chance.unwrap_or(COST)
    }

    /// The deadline of a run that starts now.
    pub(crate) fn deadline(&self) -> Option<Instant> {
        self.time_limit.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds.min(1e9)))
    }

    /// The limits of a run with a single group. The time of a node grows at most with the square of the candidates, so
    /// these limits mean the same time for any number of them: some minutes, or less than a second with `--scale auto`.
    pub(crate) fn limits(&self, candidates: usize, deadline: Option<Instant>) -> Limits {
        let thousands = candidates as f64 / 1000.0;
        let squared = thousands * thousands;
        let nodes = match self.scale {
            Scale::Fixed(_) => NODES / squared.max(1.0),
            Scale::Auto => (NODES_OF_ESTIMATES / squared).min(NODES),
        };
        // An explicit limit is used in full: such a search does not stall.
        let stall = if self.work_limit.is_some() { u64::MAX } else { (nodes / STALL) as u64 };
        Limits { work: self.work_limit.unwrap_or(nodes as u64), stall, deadline }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histories_of_earlier_versions_are_read() {
        let written = serde_json::json!({
            "test": "root", "probability": 0.95, "scale": [0.5, 2.0], "readmit": false, "admit": 0.99, "drop": 0.9999,
            "apply_scale": false,
        });
        let options: Options = serde_json::from_value(written).unwrap();
        let scale = Scale::Fixed(Scales { odometry: 0.5, landmark: 2.0 });
        assert_eq!(options, Options { test: Test::Root, probability: 0.95, scale, ..Options::default() });
    }

    #[test]
    fn the_search_after_an_estimate_is_short_and_the_papers_is_as_it_was() {
        let plain = Options::default();
        let estimated = Options { scale: Scale::Auto, ..Options::default() };
        let work = |options: &Options, candidates| options.limits(candidates, None).work;
        assert_eq!((work(&plain, 500), work(&plain, 2000)), (20_000_000, 5_000_000));
        // sphere_a has 6448 candidates; each node takes more than a millisecond there.
        assert!(work(&estimated, 6448) < 200, "{}", work(&estimated, 6448));
        assert!(work(&estimated, 100) >= 99_000, "{}", work(&estimated, 100));
        assert_eq!(work(&Options { work_limit: Some(7), ..estimated }, 6448), 7);
    }
}

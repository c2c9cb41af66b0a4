//! How recognition works: the options of the program.

use anyhow::ensure;
use serde::Serialize;

use crate::scan_context::ContextOptions;

/// What a keyframe is described by, and which candidates are kept.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[cfg_attr(feature = "cli", group(skip))]
pub struct Settings {
    /// Describe a keyframe by what was seen within this path length before and after it, metres
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Settings::DEFAULT.submap_length, help_heading = "Places"))]
    pub submap_length: f64,

    /// Describe walls up to this distance from the keyframe, metres
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Settings::DEFAULT.radius, conflicts_with = "velodyne", help_heading = "Places"))]
    pub radius: f64,

    /// Propose no two keyframes within this path length of each other, metres
    #[cfg_attr(feature = "cli", arg(long, value_name = "METRES", default_value_t = Settings::DEFAULT.exclusion_length, help_heading = "Places"))]
    pub exclusion_length: f64,

    /// Propose at most this many places for each keyframe
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Settings::DEFAULT.candidates, help_heading = "Candidates"))]
    pub candidates: usize,

    /// Keep a candidate if at least this share of what both saw agrees, 0 to 1; lower values give more candidates, and more wrong ones
    #[cfg_attr(feature = "cli", arg(long, value_name = "SHARE", default_value_t = Settings::DEFAULT.least_agreement, help_heading = "Candidates"))]
    pub least_agreement: f64,

    /// Keep a candidate if its score, the probability that it is correct, is at least this, 0 to 1; higher values give fewer candidates, and fewer wrong ones
    #[cfg_attr(feature = "cli", arg(long, value_name = "P", default_value_t = Settings::DEFAULT.least_score, help_heading = "Candidates"))]
    pub least_score: f64,

    /// Set the number of different words that are learnt from the scans
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Settings::DEFAULT.vocabulary, conflicts_with = "words", help_heading = "Probability"))]
    pub vocabulary: usize,

    /// Set the probability that a keyframe sees a place that no other keyframe saw
    #[cfg_attr(feature = "cli", arg(long, value_name = "P", default_value_t = Settings::DEFAULT.new_place, help_heading = "Probability"))]
    pub new_place: f64,

    /// Set the probability that a thing that is there is seen as its word
    #[cfg_attr(feature = "cli", arg(long, value_name = "P", default_value_t = Settings::DEFAULT.seen, help_heading = "Probability"))]
    pub seen: f64,

    /// Set the share of a word's sightings that have nothing to do with the place
    #[cfg_attr(feature = "cli", arg(long, value_name = "P", default_value_t = Settings::DEFAULT.imagined, help_heading = "Probability"))]
    pub imagined: f64,

    /// Set the seed of the vocabulary
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Settings::DEFAULT.seed, conflicts_with = "words", help_heading = "Probability"))]
    pub seed: u64,

    /// How three-dimensional scans are described.
    #[cfg_attr(feature = "cli", command(flatten))]
    #[serde(flatten)]
    pub context: ContextOptions,
}

impl Settings {
    /// The defaults.
    pub const DEFAULT: Self = Self {
        submap_length: 6.0,
        radius: 10.0,
        exclusion_length: 15.0,
        candidates: 4,
        least_agreement: 0.6,
        least_score: 0.0,
        vocabulary: 400,
        new_place: 0.5,
        seen: 0.4,
        imagined: 0.95,
        seed: 1,
        context: ContextOptions::DEFAULT,
    };

    /// Refuses meaningless values.
    ///
    /// # Errors
    ///
    /// A length is not positive, or a probability is not one.
    pub fn check(&self) -> anyhow::Result<()> {
        for (option, value) in [
            ("--submap-length", self.submap_length),
            ("--radius", self.radius),
            ("--exclusion-length", self.exclusion_length),
        ] {
            ensure!(
                value.is_finite() && value > 0.0,
                "{option} is {value}; give a positive length in metres"
            );
        }
        ensure!(
            self.exclusion_length > self.submap_length,
            "--exclusion-length {} is not above --submap-length {}; keyframes with the same surroundings would be proposed",
            self.exclusion_length,
            self.submap_length
        );
        for (option, value) in [
            ("--least-agreement", self.least_agreement),
            ("--least-score", self.least_score),
            ("--new-place", self.new_place),
            ("--seen", self.seen),
            ("--imagined", self.imagined),
        ] {
            ensure!((0.0..=1.0).contains(&value), "{option} is {value}; give a number from 0 to 1");
        }
        ensure!(self.seen > 0.0 && self.seen < 1.0, "--seen is {}; give a number between 0 and 1", self.seen);
        ensure!(
            self.imagined < 1.0,
            "--imagined is {}; if all sightings are by chance, words say nothing",
            self.imagined
        );
        ensure!(self.candidates > 0, "--candidates is 0; give at least 1");
        ensure!(self.vocabulary > 1, "--vocabulary is {}; give at least 2", self.vocabulary);
        self.context.check()
    }
}

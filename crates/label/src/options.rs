//! The options of labelling.

use anyhow::bail;
use posecut_stage::Source;
use serde::Serialize;

/// What becomes of the measurements of landmark edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Measurements {
    /// They stay as they are
    Keep,
    /// All become "the same place", as from a recogniser without geometry
    Zero,
}

/// Where labels come from. Files are in the history by their digests.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
#[group(skip)]
pub struct Options {
    /// Take labels from this CSV file: columns i, j and inlier (1 or 0); where there is a column kind, from rows `loop`
    #[arg(long, value_name = "FILE", group = "source", help_heading = "Source of labels")]
    #[serde(skip)]
    pub labels: Option<Source>,

    /// Take the correct edges from this list, one pair of node ids a line in either order; all others are incorrect
    #[arg(long, value_name = "FILE", group = "source", help_heading = "Source of labels")]
    #[serde(skip)]
    pub correct_pairs: Option<Source>,

    /// Label every landmark edge correct
    #[arg(long, group = "source", help_heading = "Source of labels")]
    pub all_correct: bool,

    /// Compare edges with these ground-truth poses: a pose graph (JSON Lines) with the same node ids, or with --times a CSV file of time, x, y, heading
    #[arg(long, value_name = "FILE", group = "source", help_heading = "Source of labels")]
    #[serde(skip)]
    pub ground_truth: Option<Source>,

    /// Compare edges with the poses that the nodes have, and keep these as ground truth only
    #[arg(long, group = "source", help_heading = "Source of labels")]
    pub vertices: bool,

    /// Times of the nodes for --ground-truth, seconds, one a line: the first for node 0
    #[arg(long, value_name = "FILE", requires = "ground_truth", help_heading = "Ground truth")]
    #[serde(skip)]
    pub times: Option<Source>,

    /// Call an edge correct within this distance of the ground truth, metres; `inf` compares rotations alone
    #[arg(long, value_name = "METRES", default_value_t = 2.0, help_heading = "Ground truth")]
    pub tolerance_translation: f64,

    /// Call an edge correct within this angle of the ground truth, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 15.0, help_heading = "Ground truth")]
    pub tolerance_rotation: f64,

    /// Interpolate no ground truth across a longer silence than this, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0, help_heading = "Ground truth")]
    pub longest_silence: f64,

    /// Call an edge incorrect where an end has no ground truth, instead of refusing it
    #[arg(long, help_heading = "Ground truth")]
    pub unknown_incorrect: bool,

    /// What becomes of the measurements of landmark edges
    #[arg(long, value_enum, default_value_t = Measurements::Keep)]
    pub measurements: Measurements,
}

impl Options {
    /// Refuses meaningless numbers.
    pub fn check(&self) -> anyhow::Result<()> {
        for (name, value) in [
            ("--tolerance-translation", self.tolerance_translation),
            ("--tolerance-rotation", self.tolerance_rotation),
            ("--longest-silence", self.longest_silence),
        ] {
            if !(value > 0.0) {
                bail!("{name} is {value}, and must be a positive number");
            }
        }
        Ok(())
    }
}

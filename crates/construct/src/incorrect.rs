//! Landmark edges that a place recogniser makes by mistake.

mod claims;
mod corridor;
mod grouped;
mod near_miss;
mod uniform;

use std::collections::HashSet;

use posecut_random::ChaCha8Rng;
use serde::Serialize;

pub(crate) use claims::Claims;

use crate::viewpoint::{Headed, Viewpoint};
use crate::{ConstructError, Options};

/// How incorrect landmark edges come about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum IncorrectKind {
    /// Independent edges, uniform over all pairs of distant viewpoints (the paper's)
    Uniform,
    /// Perceptual aliasing: a stretch of one experience is matched to a stretch of another, viewpoint by viewpoint
    Grouped,
    /// Near viewpoints with a pose that is off by metres or by a large angle
    NearMiss,
    /// Repeating places: edges all over the map are off by the same displacement
    Corridor,
}

impl IncorrectKind {
    /// The value of `--incorrect-kind`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Grouped => "grouped",
            Self::NearMiss => "near-miss",
            Self::Corridor => "corridor",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Self::Uniform | Self::Corridor => "decrease --incorrect-rate or --incorrect-distance",
            Self::Grouped => "decrease --incorrect-rate, --incorrect-distance or --group-length",
            Self::NearMiss => "decrease --incorrect-rate, or increase --incorrect-distance",
        }
    }
}

/// An edge whose measurement is wrong.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FalseMatch<G> {
    /// The viewpoint of the earlier experience.
    pub(crate) from: usize,
    /// The viewpoint of the later experience.
    pub(crate) to: usize,
    /// The measured pose of `to` in the frame of `from`.
    pub(crate) measurement: G,
    /// The mistake that the edge belongs to, for kinds in which one mistake makes many edges.
    pub(crate) group: Option<usize>,
}

/// The input of all kinds of mistakes.
pub(crate) struct Scene<'a, G> {
    pub(crate) viewpoints: &'a [Viewpoint<G>],
    /// The distribution of the relative poses that edges claim.
    pub(crate) claims: Claims<'a, G>,
    pub(crate) options: &'a Options,
}

/// The number of incorrect edges for a given share among all landmark edges: `correct * rate / (1 - rate)`.
pub(crate) fn count(correct: usize, rate: f64) -> usize {
    (correct as f64 * rate / (1.0 - rate)).round() as usize
}

/// Draws the wanted number of false matches, between different pairs of viewpoints of different experiences.
pub(crate) fn false_matches<G: Headed<DOF>, const DOF: usize>(
    scene: &Scene<'_, G>,
    wanted: usize,
    random: &mut ChaCha8Rng,
) -> Result<Vec<FalseMatch<G>>, ConstructError> {
    let matches = match scene.options.incorrect_kind {
        IncorrectKind::Uniform => uniform::draw(scene, wanted, random),
        IncorrectKind::Grouped => grouped::draw(scene, wanted, random),
        IncorrectKind::NearMiss => near_miss::draw(scene, wanted, random),
        IncorrectKind::Corridor => corridor::draw(scene, wanted, random),
    };
    if matches.len() < wanted {
        return Err(ConstructError::TooFewWrongPairs {
            rate: scene.options.incorrect_rate,
            wanted,
            found: matches.len(),
            kind: scene.options.incorrect_kind,
            distance: scene.options.incorrect_distance,
            remedy: scene.options.incorrect_kind.remedy(),
        });
    }
    Ok(matches)
}

impl<G> Scene<'_, G> {
    /// The pair with the earlier experience first; `None` unless it is far apart and in different experiences.
    fn distant(&self, one: usize, other: usize) -> Option<(usize, usize)> {
        let pair = if self.viewpoints[one].experience < self.viewpoints[other].experience {
            (one, other)
        } else {
            (other, one)
        };
        let (from, to) = (&self.viewpoints[pair.0], &self.viewpoints[pair.1]);
        let wrong = from.experience != to.experience && from.distance(to) > self.options.incorrect_distance;
        wrong.then_some(pair)
    }
}

/// The most draws for each wanted pair; beyond that the request counts as impossible.
const DRAWS_PER_PAIR: usize = 1000;

/// Pairs of viewpoints that have a false match already.
type Taken = HashSet<(usize, usize)>;

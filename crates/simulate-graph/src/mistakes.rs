//! Incorrect landmark edges, of four kinds.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::SVector;
use posecut_geometry::{LieGroup, translations};
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;
use serde::Serialize;

use crate::landmarks::Scene;
use crate::noise::normal;

/// How incorrect edges arise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Mistake {
    /// Two places look alike: single edges between any two viewpoints
    Uniform,
    /// Two stretches look alike: edges that agree with each other
    Grouped,
    /// A corridor repeats itself: edges between near viewpoints, all displaced by the same length along the path
    Corridor,
    /// A match of the right place is wrong by metres, half of the time with the right heading
    NearMiss,
}

/// Successive edges of a grouped mistake.
const STRETCH: std::ops::RangeInclusive<usize> = 5..=30;
/// The period of a corridor, metres.
const PERIOD: std::ops::Range<f64> = 2.0..8.0;
/// The largest rotation of a near miss, radians.
const MISSED_ANGLE: f64 = 0.5;
/// A mistake is at least this long, metres, and this many deviations of correct edges: shorter ones are noise.
const LEAST: (f64, f64) = (0.5, 6.0);
/// A near miss is at most this many times as long.
const MOST: f64 = 5.0;
/// Attempts to draw an edge, in a scene that may have no room for it.
const ATTEMPTS: usize = 50;

/// The motions that incorrect edges claim, by their viewpoints.
pub(crate) type Claims<G> = BTreeMap<(usize, usize), (Mistake, G)>;

impl Mistake {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Uniform, Self::Grouped, Self::Corridor, Self::NearMiss];

    /// The value of `--incorrect-kind`, and of `truth.mistake` in the graph.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Grouped => "grouped",
            Self::Corridor => "corridor",
            Self::NearMiss => "near-miss",
        }
    }

    /// Draws up to `wanted` edges between pairs without a correct edge, and without noise; fewer where the scene has no room for them.
    pub(crate) fn draw<G: LieGroup<DOF>, const DOF: usize>(
        self,
        scene: &Scene<'_, G, DOF>,
        wanted: usize,
        correct: &BTreeSet<(usize, usize)>,
        claims: &mut Claims<G>,
        random: &mut ChaCha8Rng,
    ) {
        if scene.similar.is_empty() {
            return;
        }
        let least = least_error(scene);
        let period = random.random_range(PERIOD).max(least);
        let most = claims.len() + wanted;
        for _ in 0..ATTEMPTS * wanted {
            if claims.len() >= most {
                break;
            }
            let drawn = match self {
                Self::Uniform => vec![elsewhere(scene, random)],
                Self::Grouped => stretch(scene, random),
                Self::Corridor => vec![displaced(scene, period, random)],
                Self::NearMiss => vec![missed(scene, least, random)],
            };
            for (from, to, claim) in drawn {
                let error = scene.motion(from, to).between(&claim);
                let [x, y, z] = error.translation();
                let is_wrong = x.hypot(y).hypot(z) >= least;
                let pair = (from.min(to), from.max(to));
                let is_free = scene.may_match(from, to) && !correct.contains(&pair);
                if is_wrong && is_free && claims.len() < most {
                    let claim = if from < to { claim } else { claim.inverse() };
                    claims.entry(pair).or_insert((self, claim));
                }
            }
        }
    }
}

/// The least error of an incorrect edge, metres.
fn least_error<G, const DOF: usize>(scene: &Scene<'_, G, DOF>) -> f64 {
    let character = scene.character;
    let (metres, deviations) = LEAST;
    metres.max(deviations * character.landmark_ratio.max(1.0) * character.landmark_sigma.0)
}

/// A viewpoint of any robot.
fn viewpoint<G, const DOF: usize>(scene: &Scene<'_, G, DOF>, random: &mut ChaCha8Rng) -> usize {
    random.random_range(0..scene.viewpoints.len())
}

/// A pair that sees the same place.
fn pair<G, const DOF: usize>(scene: &Scene<'_, G, DOF>, random: &mut ChaCha8Rng) -> (usize, usize) {
    scene.similar[random.random_range(0..scene.similar.len())]
}

/// Any two viewpoints, with a motion that correct edges have somewhere.
fn elsewhere<G: LieGroup<DOF>, const DOF: usize>(
    scene: &Scene<'_, G, DOF>,
    random: &mut ChaCha8Rng,
) -> (usize, usize, G) {
    let (from, to) = pair(scene, random);
    (viewpoint(scene, random), viewpoint(scene, random), scene.motion(from, to))
}

/// Two stretches that are taken for one: all edges claim that the same rigid motion lays one upon the other, as far as they stay in sight.
fn stretch<G: LieGroup<DOF>, const DOF: usize>(
    scene: &Scene<'_, G, DOF>,
    random: &mut ChaCha8Rng,
) -> Vec<(usize, usize, G)> {
    let (from, to, claim) = elsewhere(scene, random);
    let forwards: bool = random.random();
    let of_same_robot = |one: usize, other: usize| {
        other < scene.viewpoints.len() && scene.viewpoints[one].robot == scene.viewpoints[other].robot
    };
    let pose = |index: usize| scene.viewpoints[index].pose;
    let mut found = Vec::new();
    for step in 0..random.random_range(STRETCH) {
        let Some(other) = (if forwards { Some(to + step) } else { to.checked_sub(step) }) else { break };
        if !of_same_robot(from, from + step) || !of_same_robot(to, other) {
            break;
        }
        let before = pose(from + step).between(&pose(from));
        let after = pose(to).between(&pose(other));
        let motion = before.compose(&claim).compose(&after);
        if !scene.is_in_sight(&motion) {
            break;
        }
        found.push((from + step, other, motion));
    }
    found
}

/// Near viewpoints, displaced along the path of the first by one period or two, either way.
fn displaced<G: LieGroup<DOF>, const DOF: usize>(
    scene: &Scene<'_, G, DOF>,
    period: f64,
    random: &mut ChaCha8Rng,
) -> (usize, usize, G) {
    let (from, to) = pair(scene, random);
    let times = [-2.0, -1.0, -1.0, 1.0, 1.0, 2.0][random.random_range(0..6)];
    let mut along = SVector::<f64, DOF>::zeros();
    along[0] = times * period;
    (from, to, G::exp(&along).compose(&scene.motion(from, to)))
}

/// Near viewpoints whose motion is wrong by a displacement in any direction, and half of the time by a rotation.
fn missed<G: LieGroup<DOF>, const DOF: usize>(
    scene: &Scene<'_, G, DOF>,
    least: f64,
    random: &mut ChaCha8Rng,
) -> (usize, usize, G) {
    let (from, to) = pair(scene, random);
    let direction =
        SVector::<f64, DOF>::from_fn(|axis, _| if axis < translations(DOF) { normal(random) } else { 0.0 });
    let length = least * random.random_range(1.0..MOST);
    let mut error = direction * (length / direction.norm().max(f64::MIN_POSITIVE));
    if random.random::<bool>() {
        for axis in translations(DOF)..DOF {
            error[axis] = random.random_range(-MISSED_ANGLE..MISSED_ANGLE);
        }
    }
    (from, to, scene.motion(from, to).compose(&G::exp(&error)))
}

//! Matches in the right neighbourhood with a wrong pose.

use posecut_geometry::LieGroup;
use posecut_random::ChaCha8Rng;
use rand::seq::SliceRandom as _;

use super::{FalseMatch, Scene};
use crate::Options;
use crate::correct::Similarity;
use crate::noise::with_noise;

/// Headings of a near miss may differ by this many times the limit of a correct edge.
const HEADINGS: f64 = 3.0;

/// Number of claims to try on one pair before it is given up.
const CLAIMS_PER_PAIR: usize = 100;

/// Draws pairs that are not correct edges but within `--incorrect-distance` and three times `--heading`. The claim of
/// each is drawn like those of correct edges, noise included, and is off by more than `--radius` or `--heading`. The
/// draw is uniform over such pairs. O(viewpoints + pairs).
pub(super) fn draw<G: LieGroup<DOF>, const DOF: usize>(
    scene: &Scene<'_, G>,
    wanted: usize,
    random: &mut ChaCha8Rng,
) -> Vec<FalseMatch<G>> {
    let correct = Similarity::of(scene.options);
    let near = Similarity {
        radius: scene.options.incorrect_distance,
        heading: HEADINGS * correct.heading,
        ..correct
    };
    let mut pairs = near.pairs(scene.viewpoints);
    pairs.retain(|&(from, to)| !correct.holds(&scene.viewpoints[from], &scene.viewpoints[to]));
    pairs.shuffle(random);
    let mut matches = Vec::with_capacity(wanted);
    for (from, to) in pairs {
        if matches.len() == wanted {
            break;
        }
        let truth = scene.viewpoints[from].pose.between(&scene.viewpoints[to].pose);
        let claim = (0..CLAIMS_PER_PAIR)
            .map(|_| with_noise(&scene.claims.draw(random), scene.options, random))
            .find(|claim| is_off(&truth, claim, scene.options));
        matches.extend(claim.map(|claim| FalseMatch { from, to, measurement: claim, group: None }));
    }
    matches
}

/// Whether a claim is further from the truth than the viewpoints of one place may be from each other.
fn is_off<G: LieGroup<DOF>, const DOF: usize>(truth: &G, claim: &G, options: &Options) -> bool {
    let error = truth.between(claim);
    let metres = error.translation().iter().map(|component| component.powi(2)).sum::<f64>().sqrt();
    metres > options.radius || error.rotation_angle().abs() > options.heading.to_radians()
}

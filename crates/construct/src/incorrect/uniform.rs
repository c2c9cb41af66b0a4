//! Independent false matches.

use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

use super::{DRAWS_PER_PAIR, FalseMatch, Scene, Taken};
use crate::noise::with_noise;
use crate::viewpoint::Headed;

/// Draws pairs uniformly among those further apart than `--incorrect-distance`. Each claims a relative pose drawn like
/// those of correct edges, with its own noise.
pub(super) fn draw<G: Headed<DOF>, const DOF: usize>(
    scene: &Scene<'_, G>,
    wanted: usize,
    random: &mut ChaCha8Rng,
) -> Vec<FalseMatch<G>> {
    let (viewpoints, mut taken) = (scene.viewpoints.len(), Taken::new());
    let mut pairs = Vec::with_capacity(wanted);
    for _ in 0..wanted.saturating_mul(DRAWS_PER_PAIR) {
        if pairs.len() == wanted {
            break;
        }
        let drawn = scene.distant(random.random_range(0..viewpoints), random.random_range(0..viewpoints));
        pairs.extend(drawn.filter(|&pair| taken.insert(pair)));
    }
    // Draw all pairs before all claims, so that a higher rate keeps the pairs of a lower one and adds others.
    let claim = |(from, to)| {
        let claim = scene.claims.draw(random);
        FalseMatch { from, to, measurement: with_noise(&claim, scene.options, random), group: None }
    };
    pairs.into_iter().map(claim).collect()
}

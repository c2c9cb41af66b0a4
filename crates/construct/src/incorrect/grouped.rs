//! Perceptual aliasing: two stretches that look alike.

use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

use super::{DRAWS_PER_PAIR, FalseMatch, Scene, Taken};
use crate::noise::with_noise;
use crate::viewpoint::Headed;

/// Draws stretches of consecutive viewpoints in two experiences and matches them viewpoint by viewpoint:
/// `(i + k, j + k)` for `k = 0 … length - 1`. All edges of a stretch claim the same relative pose, drawn like those of
/// correct edges, and each has its own noise. Neighbouring edges of a stretch are each other's support edges. If the
/// two stretches have the same shape, their edges are also pairwise consistent.
pub(super) fn draw<G: Headed<DOF>, const DOF: usize>(
    scene: &Scene<'_, G>,
    wanted: usize,
    random: &mut ChaCha8Rng,
) -> Vec<FalseMatch<G>> {
    let (viewpoints, mut taken) = (scene.viewpoints.len(), Taken::new());
    let (mut matches, mut group) = (Vec::with_capacity(wanted), 0);
    for _ in 0..wanted.saturating_mul(DRAWS_PER_PAIR) {
        let length = scene.options.group_length.min(wanted - matches.len());
        if length == 0 {
            break;
        }
        let drawn = scene.distant(random.random_range(0..viewpoints), random.random_range(0..viewpoints));
        let Some(stretch) = drawn.and_then(|start| stretch(scene, &taken, start, length)) else { continue };
        let claim = scene.claims.draw(random);
        for (from, to) in stretch {
            taken.insert((from, to));
            let measurement = with_noise(&claim, scene.options, random);
            matches.push(FalseMatch { from, to, measurement, group: Some(group) });
        }
        group += 1;
    }
    matches
}

/// The stretch that starts at a pair; `None` if it leaves its experiences, comes near the truth or overlaps another.
fn stretch<G>(
    scene: &Scene<'_, G>,
    taken: &Taken,
    start: (usize, usize),
    length: usize,
) -> Option<Vec<(usize, usize)>> {
    let experience = |index: usize| scene.viewpoints.get(index).map(|viewpoint| viewpoint.experience);
    let step = |k: usize| {
        let (from, to) = (start.0 + k, start.1 + k);
        let within = experience(from) == experience(start.0) && experience(to) == experience(start.1);
        let pair = if within { scene.distant(from, to)? } else { return None };
        (!taken.contains(&pair)).then_some(pair)
    };
    (0..length).map(step).collect()
}

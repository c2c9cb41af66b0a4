//! Places that repeat at a fixed displacement, like parallel corridors or the doors along one.

use posecut_stage::ChaCha8Rng;
use rand::RngExt as _;

use super::{DRAWS_PER_PAIR, FalseMatch, Scene, Taken};
use crate::correct::Similarity;
use crate::noise::with_noise;
use crate::viewpoint::{Headed, Viewpoint};

/// The longest displacement, as a multiple of `--incorrect-distance`.
const LONGEST: f64 = 4.0;

/// Draws a displacement between two viewpoints of like heading, longer than `--incorrect-distance` and at most
/// four times as long; then every pair of viewpoints that far apart, within `--radius` and `--heading`, is
/// taken for the same place. The measurement is right but for the displacement, plus noise: all edges of one
/// displacement claim one and the same wrong alignment of the experiences, so that they are pairwise
/// consistent wherever they lie. A displacement is used up, from a random pair on, before the next is drawn.
pub(super) fn draw<G: Headed<DOF>, const DOF: usize>(
    scene: &Scene<'_, G>,
    wanted: usize,
    random: &mut ChaCha8Rng,
) -> Vec<FalseMatch<G>> {
    let (viewpoints, mut taken) = (scene.viewpoints, Taken::new());
    let (mut matches, mut group) = (Vec::with_capacity(wanted), 0);
    for _ in 0..wanted.saturating_mul(DRAWS_PER_PAIR) {
        if matches.len() == wanted {
            break;
        }
        let pair =
            scene.distant(random.random_range(0..viewpoints.len()), random.random_range(0..viewpoints.len()));
        let Some(repeats) = pair.and_then(|(from, to)| repeats(scene, &viewpoints[from], &viewpoints[to]))
        else {
            continue;
        };
        let mut pairs = repeats.pairs(viewpoints);
        pairs.retain(|&(from, to)| scene.distant(from, to).is_some());
        let start = random.random_range(0..pairs.len().max(1));
        pairs.rotate_left(start);
        pairs.retain(|&pair| taken.insert(pair));
        for (from, to) in pairs.into_iter().take(wanted - matches.len()) {
            let shift = displaced(&viewpoints[from].pose, repeats.displacement);
            let measurement = with_noise(&shift.between(&viewpoints[to].pose), scene.options, random);
            matches.push(FalseMatch { from, to, measurement, group: Some(group) });
        }
        group += 1;
    }
    matches
}

/// The displacement between two viewpoints as a rule for mistaking one place for another, if it may be one.
fn repeats<G>(scene: &Scene<'_, G>, from: &Viewpoint<G>, to: &Viewpoint<G>) -> Option<Similarity> {
    let displacement = std::array::from_fn(|axis| to.position[axis] - from.position[axis]);
    let rule = Similarity { displacement, ..Similarity::of(scene.options) };
    let near_enough = from.distance(to) <= LONGEST * scene.options.incorrect_distance;
    (near_enough && rule.holds(from, to)).then_some(rule)
}

/// A pose moved in the world, its heading kept.
fn displaced<G: Headed<DOF>, const DOF: usize>(pose: &G, displacement: [f64; 3]) -> G {
    let mut components = pose.components();
    let axes = if DOF == 3 { 2 } else { 3 };
    for (component, shift) in components.iter_mut().zip(displacement).take(axes) {
        *component += shift;
    }
    G::from_components(&components).unwrap_or_else(G::identity)
}

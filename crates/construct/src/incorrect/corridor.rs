//! Places that repeat at a fixed displacement, such as parallel corridors, or doors along one corridor.

use posecut_geometry::translations;
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

use super::{DRAWS_PER_PAIR, FalseMatch, Scene, Taken};
use crate::correct::Similarity;
use crate::noise::with_noise;
use crate::viewpoint::{Headed, Viewpoint};

/// The longest displacement, as a multiple of `--incorrect-distance`.
const LONGEST: f64 = 4.0;

/// Draws a displacement between two viewpoints of similar heading, longer than `--incorrect-distance` and at most four
/// times as long. Every pair of viewpoints with that displacement, within `--radius` and `--heading`, is then taken for
/// the same place. The measurement is the true one moved by the displacement, plus noise. All edges of one displacement
/// thus claim the same wrong alignment of the experiences, and are pairwise consistent wherever they are. All pairs of
/// a displacement are used, starting with a random one, before the next displacement is drawn.
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

/// The displacement between two viewpoints as a rule for mistaking places; `None` if they are not eligible.
fn repeats<G>(scene: &Scene<'_, G>, from: &Viewpoint<G>, to: &Viewpoint<G>) -> Option<Similarity> {
    let displacement = std::array::from_fn(|axis| to.position[axis] - from.position[axis]);
    let rule = Similarity { displacement, ..Similarity::of(scene.options) };
    let near_enough = from.distance(to) <= LONGEST * scene.options.incorrect_distance;
    (near_enough && rule.holds(from, to)).then_some(rule)
}

/// A pose translated in the world, with the same heading.
fn displaced<G: Headed<DOF>, const DOF: usize>(pose: &G, displacement: [f64; 3]) -> G {
    let mut components = pose.components();
    for (component, shift) in components.iter_mut().zip(displacement).take(translations(DOF)) {
        *component += shift;
    }
    G::from_components(&components).unwrap_or_else(G::identity)
}

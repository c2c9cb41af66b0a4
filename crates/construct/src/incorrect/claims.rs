//! What a false match claims: "here, within a few metres", as correct matches do.

use posecut_geometry::LieGroup;
use posecut_stage::ChaCha8Rng;
use rand::RngExt as _;

use crate::Options;

/// Relative poses among which the neighbour of a drawn one is looked for.
const SAMPLE: usize = 64;

/// The distribution of the correct matches' true relative poses.
///
/// A draw must not repeat one of them: an edge whose measurement has a twin among the correct edges gives itself
/// away. So a draw lies between a random relative pose and a similar one.
pub(crate) struct Claims<'a, G> {
    relative: &'a [G],
    /// Metres and radians by which relative poses may differ and still be similar.
    scale: [f64; 2],
}

impl<'a, G> Claims<'a, G> {
    /// From the true relative poses of all spatially similar pairs, at least one.
    pub(crate) fn of(relative: &'a [G], options: &Options) -> Self {
        Self { relative, scale: [options.radius, options.heading.to_radians()] }
    }

    /// A relative pose without noise: a random point on the geodesic from a random relative pose to the most
    /// similar of a random sample. Where none is similar, the relative pose itself. O(1).
    pub(crate) fn draw<const DOF: usize>(&self, random: &mut ChaCha8Rng) -> G
    where
        G: LieGroup<DOF>,
    {
        let count = self.relative.len();
        let drawn = random.random_range(0..count);
        let first = &self.relative[drawn];
        let mut nearest: Option<(f64, usize)> = None;
        for _ in 0..SAMPLE {
            let other = random.random_range(0..count);
            let difference = self.difference(first, &self.relative[other]);
            if other != drawn && difference < nearest.map_or(1.0, |(least, _)| least) {
                nearest = Some((difference, other));
            }
        }
        let fraction = random.random_range(0.0..1.0);
        nearest.map_or(*first, |(_, other)| first.interpolate(&self.relative[other], fraction))
    }

    /// How much two relative poses differ, as a multiple of what similar ones may.
    fn difference<const DOF: usize>(&self, first: &G, second: &G) -> f64
    where
        G: LieGroup<DOF>,
    {
        let between = first.between(second);
        let metres = between.translation().iter().map(|component| component.powi(2)).sum::<f64>().sqrt();
        (metres / self.scale[0]).hypot(between.rotation_angle() / self.scale[1])
    }
}

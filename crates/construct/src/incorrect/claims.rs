//! The relative poses that false matches claim: within a few metres, as correct matches do.

use posecut_geometry::LieGroup;
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

use crate::Options;

/// Number of random relative poses that are compared with the drawn one to find the most similar.
const SAMPLE: usize = 64;

/// The distribution of the correct matches' true relative poses.
///
/// A draw must not repeat one of them: an incorrect edge with the same measurement as a correct one could be
/// recognised. A draw therefore lies between a random relative pose and a similar one.
pub(crate) struct Claims<'a, G> {
    relative: &'a [G],
    /// Two relative poses are similar if they differ by at most this: metres, radians.
    scale: [f64; 2],
}

impl<'a, G> Claims<'a, G> {
    /// Builds the distribution from the true relative poses of all spatially similar pairs, at least one.
    pub(crate) fn of(relative: &'a [G], options: &Options) -> Self {
        Self { relative, scale: [options.radius, options.heading.to_radians()] }
    }

    /// Draws a relative pose without noise: a random point on the geodesic from a random relative pose to the most
    /// similar one of a random sample, or the relative pose itself if none is similar. O(1).
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

    /// The difference of two relative poses as a multiple of the limit for similar ones.
    fn difference<const DOF: usize>(&self, first: &G, second: &G) -> f64
    where
        G: LieGroup<DOF>,
    {
        let between = first.between(second);
        let metres = between.translation().iter().map(|component| component.powi(2)).sum::<f64>().sqrt();
        (metres / self.scale[0]).hypot(between.rotation_angle() / self.scale[1])
    }
}

//! The usual motion of a robot, from its motions over many stretches of the same length.

use nalgebra::{SMatrix, SVector};
use posecut_pcm::chain::Chain;

use crate::evidence::{CLIP, compare};
use crate::model::Motion;

/// The fewest motions that determine the usual one.
const FEWEST: usize = 20;
/// Steps that serve as examples.
const EXAMPLES: usize = 32;

/// Mean and covariance of motions (in the frame of their end), from their logarithms; `None` if there are too few.
pub(crate) fn usual_motion<G: Motion<DOF>, const DOF: usize>(
    motions: &[SVector<f64, DOF>],
) -> Option<(G, SMatrix<f64, DOF, DOF>)> {
    if motions.len() < FEWEST {
        return None;
    }
    let count = motions.len() as f64;
    let mean = motions.iter().sum::<SVector<f64, DOF>>() / count;
    let scatter: SMatrix<f64, DOF, DOF> =
        motions.iter().map(|motion| (motion - mean) * (motion - mean).transpose()).sum();
    Some((G::exp(&mean), scatter / count))
}

/// The poses at both ends of every stretch of so many steps.
pub(crate) fn stretches<G, const DOF: usize>(
    chains: &[Chain<G, DOF>],
    length: usize,
) -> impl Iterator<Item = (&G, &G)> {
    chains.iter().flat_map(move |chain| chain.poses.iter().zip(chain.poses.iter().skip(length)))
}

/// The distribution of a single step: an equal mixture of a wide normal one and examples. The wide one alone says little where a robot mostly
/// goes straight and turns sharply now and then; examples alone miss a step that is slower than all others.
#[derive(Clone)]
pub(crate) struct UsualStep<G, const DOF: usize> {
    mean: G,
    covariance: SMatrix<f64, DOF, DOF>,
    examples: Vec<G>,
}

impl<G: Motion<DOF>, const DOF: usize> UsualStep<G, DOF> {
    /// The steps of these chains; `None` if there are too few.
    pub(crate) fn of(chains: &[Chain<G, DOF>]) -> Option<Self> {
        let steps: Vec<G> = stretches(chains, 1).map(|(before, after)| before.between(after)).collect();
        let logarithms: Vec<_> = steps.iter().map(G::log).collect();
        let (mean, covariance) = usual_motion(&logarithms)?;
        let examples = steps.iter().copied().step_by(steps.len().div_ceil(EXAMPLES)).collect();
        Some(Self { mean, covariance, examples })
    }

    /// Log-likelihood ratio of a motion, known with the covariance `own` in the frame of its end, as such a step against chance, whose second
    /// moment is `apart`. Errors are multivariate t with `tail` degrees of freedom.
    pub(crate) fn evidence(
        &self,
        motion: &G,
        own: &SMatrix<f64, DOF, DOF>,
        apart: &SMatrix<f64, DOF, DOF>,
        tail: f64,
    ) -> f64 {
        let against_chance = |usual: &G, covariance: &SMatrix<f64, DOF, DOF>| {
            compare(&usual.between(motion).log(), covariance, apart, apart, tail)
                .map_or(-CLIP, |found| found.distant())
        };
        let wide = against_chance(&self.mean, &(own + self.covariance));
        if wide < 0.0 {
            // Examples are not far from the others.
            return wide;
        }
        let near: f64 = self.examples.iter().map(|example| against_chance(example, own).exp()).sum();
        (0.5 * (wide.exp() + near / self.examples.len() as f64)).ln()
    }
}

//! Gaussian and heavy-tailed noise of measurements.

use nalgebra::SVector;
use posecut_geometry::{LieGroup, translations};
use posecut_random::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution as _, StandardNormal};

/// The degrees of freedom of heavy tails.
const TAILS: f64 = 4.0;

/// A standard normal number.
pub(crate) fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// Standard deviations in translation (metres) and rotation (radians), each axis by itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Noise {
    pub(crate) sigma: (f64, f64),
    /// Whether all axes share a factor that makes them a multivariate t with [`TAILS`] degrees of freedom.
    pub(crate) heavy_tails: bool,
}

impl Noise {
    /// `motion * Exp(noise)`.
    pub(crate) fn applied<G: LieGroup<DOF>, const DOF: usize>(
        self,
        motion: &G,
        random: &mut ChaCha8Rng,
    ) -> G {
        let tangent = tangent::<DOF>(self.sigma, random);
        // Drawn for normal noise, too, so that the tails change nothing else. The degrees of freedom are positive, so the distribution exists.
        let squared = ChiSquared::new(TAILS).map(|distribution| distribution.sample(random));
        let factor = match squared {
            Ok(squared) if self.heavy_tails => (TAILS / f64::max(squared, f64::MIN_POSITIVE)).sqrt(),
            _ => 1.0,
        };
        motion.compose(&G::exp(&(tangent * factor)))
    }
}

/// A normal tangent vector, translations first.
pub(crate) fn tangent<const DOF: usize>(
    (translation, rotation): (f64, f64),
    random: &mut ChaCha8Rng,
) -> SVector<f64, DOF> {
    SVector::from_fn(|axis, _| normal(random) * if axis < translations(DOF) { translation } else { rotation })
}

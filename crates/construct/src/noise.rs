//! Noise of landmark edges.

use nalgebra::SVector;
use posecut_geometry::covariance::isotropic_information;
use posecut_geometry::{LieGroup, translations};
use posecut_graph::{Extra, NoiseModel, PoseGraph};
use posecut_random::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use crate::Options;

/// How the errors of landmark edges are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum NoiseKind {
    /// The normal distribution
    Gaussian,
    /// Student's t distribution with 3 degrees of freedom and the normal covariance as scale matrix: the standard
    /// deviations are sqrt(3) times as large
    StudentT,
}

/// Degrees of freedom of the heavy-tailed noise: the smallest whole number with a finite variance.
const TAILS: u32 = 3;

fn sigma<const DOF: usize>(options: &Options, axis: usize) -> f64 {
    if axis < translations(DOF) {
        options.landmark_sigma_translation
    } else {
        options.landmark_sigma_rotation
    }
}

/// A draw from the noise of an edge, in the tangent space of its measurement.
fn draw_noise<const DOF: usize>(options: &Options, random: &mut ChaCha8Rng) -> SVector<f64, DOF> {
    let noise = SVector::from_fn(|axis, _| {
        let unit: f64 = StandardNormal.sample(random);
        unit * sigma::<DOF>(options, axis)
    });
    match options.noise {
        NoiseKind::Gaussian => noise,
        // The multivariate t distribution stretches all axes by one factor, because a bad match is bad in all of them.
        NoiseKind::StudentT => noise * stretch(random),
    }
}

/// The factor sqrt(nu / chi^2_nu): a normal vector multiplied by it has Student's t distribution.
fn stretch(random: &mut ChaCha8Rng) -> f64 {
    let mut squares = 0.0;
    for _ in 0..TAILS {
        let unit: f64 = StandardNormal.sample(random);
        squares += unit * unit;
    }
    (f64::from(TAILS) / squares).sqrt()
}

/// The measurement of an edge: a true relative pose with noise.
pub(crate) fn with_noise<G: LieGroup<DOF>, const DOF: usize>(
    truth: &G,
    options: &Options,
    random: &mut ChaCha8Rng,
) -> G {
    truth.compose(&G::exp(&draw_noise(options, random)))
}

/// The name of the landmark edges' noise model: either a free name, or that of a model with the same content.
pub(crate) fn add_noise_model<const DOF: usize>(graph: &mut PoseGraph, options: &Options) -> String {
    // The stated covariance, which may differ from that of the noise.
    let claimed = options.landmark_covariance_scale.sqrt();
    let information = isotropic_information(
        DOF,
        options.landmark_sigma_translation * claimed,
        options.landmark_sigma_rotation * claimed,
    );
    let model = NoiseModel { information, extra: Extra::new() };
    let mut name = "landmark".to_owned();
    while graph.header.noise_model(&name).is_some_and(|known| *known != model) {
        name.push('+');
    }
    if graph.header.noise_model(&name).is_none() {
        graph.header.noise_models.push((name.clone(), model));
    }
    name
}

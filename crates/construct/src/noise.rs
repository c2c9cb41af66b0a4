//! Noise of landmark edges.

use nalgebra::SVector;
use posecut_geometry::covariance::isotropic_information;
use posecut_graph::{Extra, NoiseModel, PoseGraph};
use posecut_stage::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::Options;

/// Translations per axis of a tangent vector: 2 of 3 in the plane, 3 of 6 in space.
const fn translations(degrees_of_freedom: usize) -> usize {
    if degrees_of_freedom == 3 { 2 } else { 3 }
}

fn sigma<const DOF: usize>(options: &Options, axis: usize) -> f64 {
    if axis < translations(DOF) {
        options.landmark_sigma_translation
    } else {
        options.landmark_sigma_rotation
    }
}

/// A draw from the noise of an edge, in the tangent space of its measurement.
pub(crate) fn draw_noise<const DOF: usize>(options: &Options, random: &mut ChaCha8Rng) -> SVector<f64, DOF> {
    SVector::from_fn(|axis, _| {
        let unit: f64 = StandardNormal.sample(random);
        unit * sigma::<DOF>(options, axis)
    })
}

/// The name of the landmark edges' noise model, free or with the same content.
pub(crate) fn add_noise_model<const DOF: usize>(graph: &mut PoseGraph, options: &Options) -> String {
    let information =
        isotropic_information(DOF, options.landmark_sigma_translation, options.landmark_sigma_rotation);
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

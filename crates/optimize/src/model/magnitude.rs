//! The reference values of tolerances, which make them independent of the unit of length and of the scale of the information.

use nalgebra::SMatrix;

use super::prior::Prior;
use super::problem::Edge;
use posecut_geometry::{LieGroup, translations};

/// A graph counts as noiseless if its cost is below this share of the magnitude: residuals of a millionth. Without noise, no
/// step would meet a tolerance relative to the cost.
const NOISELESS: f64 = 1e-12;

/// The sizes of the measurements of a graph.
#[derive(Clone, Copy, Debug)]
pub struct Magnitude {
    /// The median of the measured distances that are not zero, in the graph's unit of length; 1 if all are zero.
    pub length: f64,
    /// The cost if every edge had a residual of this length along each axis of the translation and of one radian about each
    /// axis of the rotation; 0 if that is not finite.
    pub cost: f64,
}

impl Magnitude {
    /// The magnitude of these edges. O(edges).
    pub fn of<'a, G: LieGroup<DOF> + 'a, const DOF: usize>(
        edges: impl Iterator<Item = &'a Edge<G, DOF>> + Clone,
    ) -> Self {
        let length = median_of_positive(edges.clone().map(|edge| distance(&edge.measurement))).unwrap_or(1.0);
        let cost: f64 = edges.map(|edge| size(edge, length)).sum();
        Self { length, cost: if cost.is_finite() { cost } else { 0.0 } }
    }

    /// The magnitude of a graph with priors too. Their coordinates do not change the length, since the origin is arbitrary.
    pub(crate) fn with_priors<G, const DOF: usize>(self, priors: &[Prior<G, DOF>]) -> Self {
        let cost = priors.iter().fold(self.cost, |sum, prior| sum + size_of(&prior.information, self.length));
        Self { cost: if cost.is_finite() { cost } else { 0.0 }, ..self }
    }

    /// The cost below which only rounding errors remain.
    pub fn noiseless(&self) -> f64 {
        NOISELESS * self.cost
    }

    /// The largest component of a tangent vector: translations as shares of `length`, rotations in radians.
    pub fn largest<'a>(&self, tangent: impl Iterator<Item = &'a f64>, translations: usize) -> f64 {
        let scaled = |(axis, value): (usize, &f64)| {
            if axis < translations { value.abs() / self.length } else { value.abs() }
        };
        tangent.enumerate().map(scaled).fold(0.0, f64::max)
    }
}

/// The median of the values that are positive and finite, the upper one of two; `None` if there are none. O(values).
pub(crate) fn median_of_positive(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.filter(|value| *value > 0.0 && value.is_finite()).collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The cost of an edge whose residual is `length` along each axis of the translation and one radian about each rotation axis.
pub fn size<G, const DOF: usize>(edge: &Edge<G, DOF>, length: f64) -> f64 {
    size_of(&edge.information, length)
}

fn size_of<const DOF: usize>(information: &SMatrix<f64, DOF, DOF>, length: f64) -> f64 {
    let diagonal = information.diagonal();
    let (along, about) = diagonal.as_slice().split_at(translations(DOF));
    length * length * along.iter().sum::<f64>() + about.iter().sum::<f64>()
}

/// Measured distance between the two poses.
pub fn distance<G: LieGroup<DOF>, const DOF: usize>(measurement: &G) -> f64 {
    measurement.translation().iter().map(|value| value * value).sum::<f64>().sqrt()
}

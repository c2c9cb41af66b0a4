//! Agreement by chance: how many edges between random positions would have as small an innovation.

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use posecut_pcm::consistency::elsewhere;
use statrs::function::gamma::ln_gamma;

use crate::innovation::Innovation;

/// The most positions whose relative poses show the error of a false edge. More would not change the answer.
const PLACES: usize = 1000;

/// The error of an edge between random positions, and the number of edges.
pub(crate) struct ByChance<const DOF: usize> {
    /// The second moment of the relative poses between positions where landmark edges end.
    apart: SMatrix<f64, DOF, DOF>,
    edges: usize,
    /// ln Gamma(D/2 + 1)
    log_gamma: f64,
}

impl<const DOF: usize> ByChance<DOF> {
    pub(crate) fn of<G: LieGroup<DOF>>(places: &[G]) -> Self {
        let count = places.len();
        let sample: Vec<usize> = (0..count).step_by(count.div_ceil(PLACES).max(1)).collect();
        let mut apart = SMatrix::zeros();
        for (turn, &one) in sample.iter().enumerate() {
            let error = places[one].between(&places[elsewhere(count, one, turn + 1)]).log();
            apart += error * error.transpose() / sample.len() as f64;
        }
        Self { apart, edges: count, log_gamma: ln_gamma(0.5 * DOF as f64 + 1.0) }
    }

    /// How many edges between random positions would have as small an innovation: the formula of [`posecut_pcm::chance`],
    /// with the map as the witness.
    pub(crate) fn false_alarms(&self, innovation: &Innovation<DOF>, scale: f64) -> f64 {
        let near = innovation.covariance * scale;
        let determinant = |matrix: SMatrix<f64, DOF, DOF>| matrix.cholesky().map(|root| root.determinant());
        let chance = match (determinant(near), determinant(near + self.apart)) {
            (Some(near), Some(far)) => {
                let half_squared = 0.5 * innovation.squared / scale;
                (0.5 * DOF as f64 * half_squared.ln() - self.log_gamma).exp() * (near / far).sqrt()
            }
            _ => 1.0,
        };
        self.edges as f64 * chance.min(1.0)
    }
}

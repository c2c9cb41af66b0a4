//! The map that accepted closures make, and what it says of each closure.

use nalgebra::{SMatrix, SVector};
use posecut_graph::PoseGraph;
use posecut_optimize::{Edge, EdgeKind, Marginals, Options, Problem, optimize};

use crate::calibration::Calibration;
use crate::evidence::{Evidence, compare};
use crate::model::{Model, Motion};

/// Optimised poses with their covariances.
pub(crate) struct Map<G, const DOF: usize> {
    poses: Vec<G>,
    marginals: Marginals<G, DOF>,
}

/// All that the optimiser needs of a graph, read once.
pub(crate) struct Drawing<G, const DOF: usize> {
    start: Vec<G>,
    odometry: Vec<(usize, Edge<G, DOF>)>,
    /// For each closure.
    pub(crate) landmarks: Vec<Edge<G, DOF>>,
}

/// What the map says of a closure: its error, and the covariances of measurement and prediction.
pub(crate) struct Innovation<const DOF: usize> {
    pub(crate) error: SVector<f64, DOF>,
    pub(crate) covariance: SMatrix<f64, DOF, DOF>,
}

impl<G: Motion<DOF>, const DOF: usize> Drawing<G, DOF> {
    pub(crate) fn of(graph: &PoseGraph, model: &Model<G, DOF>) -> anyhow::Result<Self> {
        let measured = posecut_optimize::stage::edges::<G, DOF>(graph)?;
        let mut landmark_of = vec![None; graph.edges.len()];
        let mut odometry = Vec::new();
        for (edge, &place) in measured.edges.iter().zip(&measured.places) {
            match edge.kind {
                EdgeKind::Odometry => odometry.push((model.chains.places[edge.from].0, *edge)),
                EdgeKind::Landmark => landmark_of[place] = Some(*edge),
            }
        }
        let landmarks = model
            .closures
            .iter()
            .filter_map(|closure| landmark_of[closure.candidate.edge])
            .collect::<Vec<_>>();
        anyhow::ensure!(landmarks.len() == model.closures.len(), "a candidate has no measurement");
        let start = model.chains.places.iter().map(|&(chain, place)| model.chains.chains[chain].poses[place]);
        Ok(Self { start: start.collect(), odometry, landmarks })
    }

    /// Optimises the odometry with the accepted closures.
    pub(crate) fn map(&self, calibration: &Calibration, accepted: &[bool]) -> anyhow::Result<Map<G, DOF>> {
        let odometry = self.odometry.iter().map(|(chain, edge)| Edge {
            information: edge.information / calibration.odometry[*chain],
            ..*edge
        });
        let landmarks = self.landmarks.iter().zip(accepted).filter(|(_, accepted)| **accepted).map(
            |(edge, _)| Edge { information: edge.information / calibration.landmark, ..*edge },
        );
        let problem = Problem::new(self.start.clone(), odometry.chain(landmarks).collect())?;
        let solution = optimize(&problem, &Options { cost_tolerance: 1e-6, ..Options::default() });
        let marginals = Marginals::new(&problem, &solution.poses, &solution.weights);
        Ok(Map { poses: solution.poses, marginals })
    }
}

impl<G: Motion<DOF>, const DOF: usize> Map<G, DOF> {
    /// Evidence of closures that the map covers, without their own part in it. `None` where nothing else holds both ends.
    pub(crate) fn judge(
        &mut self,
        drawing: &Drawing<G, DOF>,
        model: &Model<G, DOF>,
        calibration: &Calibration,
        accepted: &[bool],
        asked: &[usize],
    ) -> Vec<Option<Evidence>> {
        let mut found: Vec<Option<(Innovation<DOF>, SMatrix<f64, DOF, DOF>)>> = self.innovations(drawing, calibration, accepted, asked);
        let mut distances: Vec<f64> = asked.iter().zip(&found).filter(|(closure, _)| accepted[**closure]).filter_map(|(_, found)| {
            let (innovation, _) = found.as_ref()?;
            Some(innovation.error.dot(&innovation.covariance.cholesky()?.solve(&innovation.error)))
        }).collect();
        distances.sort_by(f64::total_cmp);
        // The scale of the map's own errors, from the median.
        let scale = distances.get(distances.len() / 2).map_or(1.0, |median| (median / median_chi_square(DOF)).clamp(if distances.len() < 20 { 1.0 } else { 0.05 }, 30.0));
        if std::env::var_os("VERIFY_DEBUG").is_some() { eprintln!("scale {scale}"); }
        asked.iter().zip(&mut found).map(|(&closure, found)| {
            let (innovation, own) = found.as_ref()?;
            let covariance = innovation.covariance * scale;
            compare(&innovation.error, &covariance, &model.apart_local(closure), &(own * (scale * 900.0)))
        }).collect()
    }

    fn innovations(
        &mut self,
        drawing: &Drawing<G, DOF>,
        calibration: &Calibration,
        accepted: &[bool],
        asked: &[usize],
    ) -> Vec<Option<(Innovation<DOF>, SMatrix<f64, DOF, DOF>)>> {
        let pairs: Vec<(usize, usize)> =
            asked.iter().map(|&closure| (drawing.landmarks[closure].from, drawing.landmarks[closure].to)).collect();
        let relative = self.marginals.relative(&pairs);
        asked
            .iter()
            .zip(relative)
            .map(|(&closure, relative)| {
                let edge = &drawing.landmarks[closure];
                let own = posecut_geometry::covariance::covariance_from_information(&edge.information).ok()?
                    * calibration.landmark;
                let predicted = self.poses[edge.from].between(&self.poses[edge.to]);
                let residual = edge.measurement.between(&predicted).log();
                let innovation = innovation(residual, own, relative?, accepted[closure])?;
                Some((innovation, own))
            })
            .collect()
    }
}

fn median_chi_square(degrees: usize) -> f64 {
    if degrees == 3 { 2.366 } else { 5.348 }
}

/// The innovation of a measurement with covariance S over a prediction with covariance P. Where the measurement takes part
/// in the map, S (S - P)^-1 r with covariance S (S - P)^-1 S, for the map without it; `None` where it alone holds the ends.
fn innovation<const DOF: usize>(
    residual: SVector<f64, DOF>,
    own: SMatrix<f64, DOF, DOF>,
    predicted: SMatrix<f64, DOF, DOF>,
    in_use: bool,
) -> Option<Innovation<DOF>> {
    if !in_use {
        return Some(Innovation { error: residual, covariance: own + predicted });
    }
    let left = own - predicted;
    let left = (left + left.transpose()) * 0.5;
    let scale = own.diagonal();
    for axis in 0..DOF {
        if left[(axis, axis)] < 1e-4 * scale[axis] {
            return None;
        }
    }
    let inverse = left.cholesky()?.inverse();
    let gain = own * inverse;
    let covariance = gain * own;
    Some(Innovation { error: gain * residual, covariance: (covariance + covariance.transpose()) * 0.5 })
}

//! Tests every landmark edge against the map that the other edges make.

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use posecut_geometry::covariance::unpack_upper_triangle;
use posecut_graph::{Edge, EdgeKind, PoseGraph, for_dimension};
use posecut_pcm::calibration::divide_information;
use posecut_pcm::chain::{Covariances, covariance};
use posecut_pcm::chance::acceptable;
use posecut_pcm::chi_square_quantile;

use crate::ReadmitError;
use crate::by_chance::ByChance;
use crate::innovation::{Innovation, innovation};

/// The field with the optimiser's covariance of the pose that a landmark edge measures.
pub const PREDICTED_COVARIANCE: &str = "predicted_covariance";

/// The value of `rejected_by` that this stage sets and removes. It continues from PCM's decisions and, in later rounds,
/// from its own. It does not change rejections by other stages.
const MARK: &str = posecut_pcm::STAGE;

/// The quantile of the innovations that fixes the scale: within the bulk of the edges in use, yet far enough out to show
/// tails heavier than a Gaussian's.
const SCALE_QUANTILE: f64 = 0.9;

/// The largest estimated scale: three times the standard deviations that the information gives. Without a bound, every
/// false edge in use raises the scale, a larger scale re-admits more of them, and in the end nearly all are in use.
const LARGEST_SCALE: f64 = 9.0;

/// How the innovations decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readmission {
    /// A rejected edge is re-admitted if its innovation is within this quantile.
    pub admit: f64,
    /// An edge in use is rejected if its innovation is beyond this quantile.
    pub drop: f64,
    /// The factor that multiplies the covariances; `None`: estimated from the edges in use.
    pub scale: Option<f64>,
    /// Whether the information of landmark edges is divided by the scale.
    pub apply_scale: bool,
    /// The cost of a wrong edge, in correct ones. It limits what is re-admitted by chance, as in [`posecut_pcm::chance`].
    pub cost: f64,
}

/// The numbers of edges by result, and the scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Readmitted {
    /// Landmark edges with a measurement that are in use or were rejected by this stage.
    pub tested: usize,
    /// Rejected edges that were re-admitted.
    pub readmitted: usize,
    /// Edges in use that were rejected.
    pub dropped: usize,
    /// Rejected edges that agree with the map no better than edges between random positions. They stay rejected.
    pub by_chance: usize,
    /// Edges in use that no other edge constrains: they cannot disagree.
    pub untestable: usize,
    /// Landmark edges without a measurement.
    pub unmeasured: usize,
    /// Landmark edges that another stage has rejected.
    pub rejected_by_others: usize,
    /// The scale of the covariances.
    pub scale: f64,
    /// The estimate of the scale, if it exceeds the bound.
    pub unbounded_scale: Option<f64>,
}

/// A landmark edge to be judged.
struct Judged<const DOF: usize> {
    edge: usize,
    in_use: bool,
    innovation: Option<Innovation<DOF>>,
}

/// Re-admits and rejects landmark edges of a graph that contains the optimiser's marginals.
pub fn readmit(graph: &mut PoseGraph, options: &Readmission) -> Result<Readmitted, ReadmitError> {
    for_dimension!(graph.header.dimension, |G, DOF| judge::<G, DOF>(graph, options))
}

fn judge<G: LieGroup<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    options: &Readmission,
) -> Result<Readmitted, ReadmitError> {
    let (admit, drop) = (chi_square_quantile(options.admit, DOF)?, chi_square_quantile(options.drop, DOF)?);
    let mut result = Readmitted::default();
    let mut judged: Vec<Judged<DOF>> = Vec::new();
    let mut places = Vec::new();
    for (index, edge) in graph.edges.iter().enumerate() {
        if edge.kind != EdgeKind::Landmark {
            continue;
        }
        if edge.rejected_by.as_deref().is_some_and(|stage| stage != MARK) {
            result.rejected_by_others += 1;
            continue;
        }
        let Some(measurement) = edge.measurement.as_deref().and_then(G::from_components) else {
            result.unmeasured += 1;
            continue;
        };
        let covariance = covariance::<DOF>(graph, edge, Covariances::Needed)?;
        let predicted = predicted::<DOF>(edge)?;
        let (start, end) = (pose::<G, DOF>(graph, edge.from)?, pose::<G, DOF>(graph, edge.to)?);
        let estimate = start.between(&end);
        let innovation = predicted.and_then(|predicted| {
            innovation(&measurement, &covariance, &estimate, &predicted, edge.in_use())
        });
        judged.push(Judged { edge: index, in_use: edge.in_use(), innovation });
        places.push(end);
    }
    result.tested = judged.len();
    result.scale = if let Some(scale) = options.scale {
        scale
    } else {
        let estimate = estimated_scale(&judged)?;
        result.unbounded_scale = (estimate > LARGEST_SCALE).then_some(estimate);
        estimate.min(LARGEST_SCALE)
    };
    let by_chance = ByChance::of(&places);
    let false_alarms: Vec<Option<f64>> = judged
        .iter()
        .map(|edge| Some(by_chance.false_alarms(edge.innovation.as_ref()?, result.scale)))
        .collect();
    let agreeing = judged
        .iter()
        .zip(&false_alarms)
        .filter(|(edge, _)| edge.innovation.is_some_and(|found| found.squared / result.scale <= admit))
        .filter_map(|(_, alarms)| *alarms);
    let limit = acceptable(agreeing.collect(), options.cost);
    for (Judged { edge, in_use, innovation }, false_alarms) in judged.into_iter().zip(false_alarms) {
        let squared = innovation.map(|innovation| innovation.squared / result.scale);
        let edge = &mut graph.edges[edge];
        match (in_use, squared) {
            (true, None) => result.untestable += 1,
            (true, Some(squared)) if squared > drop => {
                edge.reject(MARK);
                result.dropped += 1;
            }
            (false, Some(squared)) if squared <= admit => {
                if false_alarms.is_some_and(|expected| expected <= limit) {
                    edge.readmit();
                    result.readmitted += 1;
                } else {
                    result.by_chance += 1;
                }
            }
            _ => {}
        }
        edge.extra.insert("pcm_innovation".to_owned(), squared.into());
    }
    if options.apply_scale {
        divide_information(graph, EdgeKind::Landmark, result.scale);
    }
    Ok(result)
}

/// The factor that makes the 0.9 quantile of the innovations in use equal to that of chi-square; 1 with fewer than ten.
fn estimated_scale<const DOF: usize>(judged: &[Judged<DOF>]) -> Result<f64, ReadmitError> {
    let used = judged.iter().filter(|edge| edge.in_use);
    let mut used: Vec<f64> =
        used.filter_map(|edge| edge.innovation).map(|innovation| innovation.squared).collect();
    if used.len() < 10 {
        return Ok(1.0);
    }
    used.sort_by(f64::total_cmp);
    let quantile = used[((used.len() - 1) as f64 * SCALE_QUANTILE).round() as usize];
    let scale = quantile / chi_square_quantile(SCALE_QUANTILE, DOF)?;
    Ok(if scale > 0.0 { scale } else { 1.0 })
}

/// The covariance that the optimiser predicts; `None` if the edges in use do not determine one.
fn predicted<const DOF: usize>(edge: &Edge) -> Result<Option<SMatrix<f64, DOF, DOF>>, ReadmitError> {
    let missing = |reason: &str| ReadmitError::Prediction { edge: edge.name(), reason: reason.to_owned() };
    let value = edge.extra.get(PREDICTED_COVARIANCE).ok_or_else(|| missing("is missing"))?;
    if value.is_null() {
        return Ok(None);
    }
    let terms: Option<Vec<f64>> =
        value.as_array().and_then(|terms| terms.iter().map(serde_json::Value::as_f64).collect());
    let terms = terms.ok_or_else(|| missing("is not a list of numbers"))?;
    unpack_upper_triangle::<DOF>(&terms)
        .map(Some)
        .map_err(|error| missing(&format!("does not fit ({error})")))
}

fn pose<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph, id: u64) -> Result<G, ReadmitError> {
    graph
        .node_index(id)
        .and_then(|index| graph.nodes[index].pose.as_deref())
        .and_then(G::from_components)
        .ok_or(ReadmitError::Pose { node: id })
}

//! Estimates by which factors the covariances are wrong, from the candidates themselves: one factor for odometry, one for
//! landmark edges.
//!
//! `loops` closes loops through neighbouring candidates, and shuffled loops for comparison. `mixture` fits variance
//! components to them by expectation-maximisation (Zhou, Hu, Zhou, Lange, JCGS 2019); [`estimate_scales`] describes the
//! model. Depends on odometry and pairs.

mod loops;
mod mixture;

use posecut_graph::{EdgeKind, PoseGraph};
use serde::Serialize;

use crate::odometry::chain::Chains;
use crate::odometry::spread::Spatial;
use crate::pairs::candidate::Group;

/// The fewest landmark edges for an estimate. The limit counts edges, not loops, because one edge closes up to nine loops.
pub const FEWEST: usize = 15;
/// The least evidence for an estimate, in nats (simulated sessions without overlap reach 11) and in nats an edge: false
/// edges between nearby positions agree a little better than edges with shuffled ends.
const EVIDENCE: f64 = 15.0;
const EVIDENCE_OF_EDGE: f64 = 0.2;

/// Factors that multiply the covariances: above 1 where the covariances are too small.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scales {
    /// Covariances of odometry.
    pub odometry: f64,
    /// Covariances of landmark edges.
    pub landmark: f64,
}

impl Scales {
    /// Leaves the covariances unchanged.
    pub const ONE: Self = Self { odometry: 1.0, landmark: 1.0 };

    /// Multiplies the covariances of chains and candidates.
    pub fn apply<G: Spatial<DOF>, const DOF: usize>(
        self,
        chains: &mut Chains<G, DOF>,
        groups: &mut [Group<G, DOF>],
    ) {
        if self == Self::ONE {
            return;
        }
        for covariance in chains.chains.iter_mut().flat_map(|chain| &mut chain.covariances) {
            *covariance *= self.odometry;
        }
        for candidate in groups.iter_mut().flat_map(|group| &mut group.candidates) {
            candidate.covariance *= self.landmark;
        }
    }
}

/// An estimate of [`Scales`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScaleEstimate {
    /// The factors: 1 if the covariances are right, below 1 if they are too large.
    pub scales: Scales,
    /// The share of neighbouring pairs that the mixture takes for correct.
    pub correct: f64,
    /// The number of loops that the estimate uses.
    pub loops: usize,
    /// The number of landmark edges that these loops start from.
    pub edges: usize,
    /// How much likelier the loops are than the same loops with shuffled ends, in nats. Each edge counts once.
    pub evidence: f64,
    /// Why the fit did not reach a maximum of the likelihood, if it did not.
    pub ended: Option<Ended>,
}

/// Where a fit ended that did not reach a maximum of the likelihood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// After the largest number of iterations.
    Iterations,
    /// At the smallest factor that is tried, e^-12.
    SmallestFactor,
    /// At the largest factor that is tried, e^12.
    LargestFactor,
    /// At the smallest allowed share of correct loops, one in a thousand.
    Share,
}

impl Ended {
    /// For messages.
    pub fn explanation(self) -> &'static str {
        match self {
            Self::Iterations => "after its last iteration without converging",
            Self::SmallestFactor => "at the smallest factor it tries, e^-12",
            Self::LargestFactor => "at the largest factor it tries, e^12",
            Self::Share => "at the bound on the share of correct loops, 0.001",
        }
    }

    /// Its name in the statistics.
    pub fn name(self) -> &'static str {
        match self {
            Self::Iterations => "iterations",
            Self::SmallestFactor => "smallest-factor",
            Self::LargestFactor => "largest-factor",
            Self::Share => "share",
        }
    }
}

/// Why there are no scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoScales {
    /// Too few landmark edges close loops: only this many.
    FewEdges(usize),
    /// The loops are not enough likelier than the same loops with shuffled ends: by this many nats.
    NoEvidence(f64),
    /// The evidence is too small, and the fit ended at this bound.
    AtBound(Ended),
}

/// Estimates the scales of the covariances from loops of different lengths. The loops go through pairs of candidates that
/// are neighbours by distance travelled and, within a chain, through one candidate and the odometry between its ends.
///
/// The covariance of a loop is a O + b L, where O is the part of the odometry and L the part of the landmark edges. The
/// error of a correct loop is modelled as multivariate t with four degrees of freedom (a robust choice: Lange, Little,
/// Taylor, JASA 1989). The error of a false loop is modelled as uniform over a region: the one that loops of the same
/// length fill when a measurement is replaced by that of a candidate far away. The two factors and the shares of correct
/// loops maximise the likelihood of this mixture, by expectation-maximisation with the variance components' update of Zhou,
/// Hu, Zhou and Lange (JCGS 2019). Finally, both factors are multiplied by one number, so that the 0.9 quantile of the
/// correct loops' squared distances equals that of chi-square: tails heavier than a Gaussian's widen the gate.
///
/// Loops cannot resolve everything. If measurements differ by no more than their noise, or if false candidates agree with
/// each other, the noise of these is taken for the noise of all. Near misses are taken for correct loops with much
/// odometry: if one candidate in ten is off by 0.5 to 3 m, at thirty times the noise at most, the odometry's factor is 2.5
/// times too large in the plane, and 6 times in space.
///
/// Large enough factors explain any loops, also those of false edges. The mixture is therefore also fitted to the same
/// loops with one end of each landmark edge shuffled. There is no estimate if the loops themselves are less than 15 nats
/// likelier (0.2 an edge if that is more), or if fewer than 15 landmark edges close them. O(N log N + 10^4 * iterations).
pub fn estimate_scales<G: Spatial<DOF>, const DOF: usize>(
    chains: &Chains<G, DOF>,
    groups: &[Group<G, DOF>],
) -> Result<ScaleEstimate, NoScales> {
    let sample = loops::sample(chains, groups);
    if sample.edges < FEWEST {
        return Err(NoScales::FewEdges(sample.edges));
    }
    let estimate = mixture::fit(&sample).ok_or(NoScales::FewEdges(0))?;
    if estimate.evidence < EVIDENCE.max(EVIDENCE_OF_EDGE * estimate.edges as f64) {
        // A fit that ended at a bound says nothing about the loops.
        match estimate.ended {
            Some(ended @ (Ended::SmallestFactor | Ended::LargestFactor)) => Err(NoScales::AtBound(ended)),
            _ => Err(NoScales::NoEvidence(estimate.evidence)),
        }
    } else {
        Ok(estimate)
    }
}

/// Divides the information of all edges of a kind that have a measurement. Information from a noise model becomes the
/// edge's own.
pub fn divide_information(graph: &mut PoseGraph, kind: EdgeKind, scale: f64) {
    for index in 0..graph.edges.len() {
        let edge = &graph.edges[index];
        if edge.kind != kind || edge.measurement.is_none() {
            continue;
        }
        let Some(information) = graph.information(edge) else { continue };
        let scaled: Vec<f64> = information.iter().map(|term| term / scale).collect();
        let edge = &mut graph.edges[index];
        edge.information = Some(scaled);
        edge.noise = None;
    }
}

//! How far the covariances are off, from the candidates themselves: one factor for odometry, one for landmark edges.
//!
//! `loops` closes loops of neighbouring candidates and shuffled ones for comparison; `mixture` fits variance components to
//! them by expectation-maximisation (Zhou, Hu, Zhou, Lange, JCGS 2019; [`estimate_scales`] says how). Depends on odometry
//! and pairs.

mod loops;
mod mixture;

use posecut_graph::{EdgeKind, PoseGraph};
use serde::Serialize;

use crate::odometry::chain::Chains;
use crate::odometry::spread::Spatial;
use crate::pairs::candidate::Group;

/// Landmark edges below which there is no estimate. Loops do not count: one edge closes up to nine of them.
pub const FEWEST: usize = 15;
/// Nats of evidence below which an estimate rests on nothing (drawn sessions without overlap reach 11), and nats an edge:
/// false edges between nearby places agree a little better than with shuffled ends.
const EVIDENCE: f64 = 15.0;
const EVIDENCE_OF_EDGE: f64 = 0.2;

/// What covariances are multiplied by: above 1 where they are too tight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scales {
    /// Covariances of odometry.
    pub odometry: f64,
    /// Covariances of landmark edges.
    pub landmark: f64,
}

impl Scales {
    /// Covariances as they are.
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
    /// The factors: 1 if the covariances are right, below 1 if they are too loose.
    pub scales: Scales,
    /// The share of pairs of neighbours that are taken for correct.
    pub correct: f64,
    /// Loops that the estimate comes from.
    pub loops: usize,
    /// Landmark edges that these loops start from.
    pub edges: usize,
    /// How much likelier the loops are than the same ones with shuffled ends, in nats; an edge counts once.
    pub evidence: f64,
    /// What kept the fit from a maximum of the likelihood, if anything did.
    pub ended: Option<Ended>,
}

/// Where a fit ended that is no maximum of the likelihood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// After the largest number of iterations.
    Iterations,
    /// At the smallest factor that is tried, e^-12.
    SmallestFactor,
    /// At the largest factor that is tried, e^12.
    LargestFactor,
    /// With as few correct loops as are allowed, one in a thousand.
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
    /// So few landmark edges close loops.
    FewEdges(usize),
    /// The loops are no likelier than the same ones with shuffled ends: by so many nats.
    NoEvidence(f64),
    /// So it is where the fit ended at a bound.
    AtBound(Ended),
}

/// Estimates the scales of the covariances from loops of different lengths: through pairs of candidates that are
/// neighbours by distance travelled, and, within a chain, through one candidate and the odometry between its places.
///
/// A loop's covariance is a O + b L, O the odometry's part and L that of its landmark edges. The error of a correct loop
/// is taken for multivariate t with four degrees of freedom (a robust choice: Lange, Little, Taylor, JASA 1989), that of a
/// false one for uniform over the region that loops as long fill whose measurement is exchanged for that of a candidate far
/// away. The two factors and the shares of correct loops maximise the likelihood of this mixture, by
/// expectation-maximisation with the variance components' update of Zhou, Hu, Zhou and Lange (JCGS 2019). At last both
/// factors are multiplied such that the 0.9 quantile of the correct loops' squared distances is that of chi-square:
/// tails heavier than a Gaussian's widen the gate.
///
/// What loops do not tell apart stays undetermined: measurements that differ by no more than their noise, and false
/// candidates that agree with each other, whose noise is then taken for everybody's. Near misses are taken for correct
/// loops with much odometry: where one candidate in ten is off by 0.5 to 3 m, at thirty times the noise at most, the
/// odometry's factor is 2.5 times too large in the plane, and 6 times in space.
///
/// Large enough factors explain any loops, those of false edges too. The mixture is therefore also fitted to the same
/// loops with one end of each landmark edge shuffled, and there is no estimate where the loops themselves are less than 15
/// nats likelier (0.2 an edge where that is more), or where fewer than 15 landmark edges close them. O(N log N + 10^4 * iterations).
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
        // A fit that a bound has kept from the loops says nothing about them.
        match estimate.ended {
            Some(ended @ (Ended::SmallestFactor | Ended::LargestFactor)) => Err(NoScales::AtBound(ended)),
            _ => Err(NoScales::NoEvidence(estimate.evidence)),
        }
    } else {
        Ok(estimate)
    }
}

/// Divides the information of all edges of a kind with a measurement; one that a noise model gave becomes the edge's own.
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

//! How far the covariances are off, from the candidates themselves: one factor for odometry, one for landmark edges.

mod loops;
mod mixture;

use serde::Serialize;

use crate::candidate::Group;
use crate::chain::Chains;
use crate::spread::Spatial;

/// Loops below which there is no estimate.
const FEWEST: usize = 50;

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
/// `None` with fewer than 50 loops. O(N log N + 10^4 * iterations).
pub fn estimate_scales<G: Spatial<DOF>, const DOF: usize>(
    chains: &Chains<G, DOF>,
    groups: &[Group<G, DOF>],
) -> Option<ScaleEstimate> {
    let sample = loops::sample(chains, groups);
    if sample.loops.len() < FEWEST {
        return None;
    }
    mixture::fit(&sample)
}

//! Graduated non-convexity: rejects outliers without a good start.
//!
//! H. Yang, P. Antonante, V. Tzoumas, L. Carlone, "Graduated non-convexity for robust spatial perception", IEEE RA-L 5(2),
//! 2020. A convex surrogate replaces the robust cost. It is minimised, made a little less convex, minimised from the last
//! result, and so on. The surrogates are kernels ([`Kernel::GemanMcClure`] with a growing width, and [`Kernel::Truncated`]).
//! Their derivatives are the weights of the paper, equations (12) and (14), so that every round is a descent of the surrogate
//! itself instead of an alternation.

use crate::descent::outcome::Outcome;
use crate::descent::workspace::Workspace;
use crate::model::kernel::Kernel;
use crate::model::lanes::LaneGroup;
use crate::model::prior::Prior;
use crate::model::problem::{Edge, EdgeKind, Problem};
use crate::model::residual::squared;
use crate::options::{Graduated, Options};
use crate::pose_group::PoseGroup;

/// Factor between one round's convexity and the next; remark 5 of the paper.
const RATE: f64 = 1.4;
/// Cost tolerance of a round: only the last round needs more digits.
const ROUND_TOLERANCE: f64 = 1e-4;
/// Maximum number of steps per round.
const ROUND_STEPS: usize = 10;
/// Maximum number of rounds: enough to graduate even a residual of 1e9 widths.
const MOST_ROUNDS: usize = 200;

impl Graduated {
    /// The surrogates, most convex first, for squared residuals up to `largest`. Remarks 5 and 6 of the paper:
    /// truncated least squares starts with `mu = c^2 / (2 r^2 - c^2)`, which grows; Geman-McClure with
    /// `mu = 2 r^2 / c^2`, which shrinks to 1.
    fn surrogates(self, largest: f64) -> Vec<Kernel> {
        let mut kernels = Vec::new();
        match self {
            Self::TruncatedLeastSquares(width) => {
                let mut convexity = width * width / (2.0 * largest - width * width);
                // From 1e3 on the surrogate equals the cost up to a thousandth of the width.
                while convexity > 0.0 && convexity < 1e3 && kernels.len() < MOST_ROUNDS {
                    kernels.push(Kernel::Truncated { width, convexity });
                    convexity *= RATE;
                }
            }
            Self::GemanMcClure(width) => {
                let mut convexity = 2.0 * largest / (width * width);
                while convexity > 1.0 && convexity.is_finite() && kernels.len() < MOST_ROUNDS {
                    kernels.push(Kernel::GemanMcClure(width * convexity.sqrt()));
                    convexity /= RATE;
                }
            }
        }
        kernels
    }

    /// Graduates from poses that minimise the cost without kernels; odometry edges keep their own kernels.
    /// Priors are graduated like landmark edges.
    pub(crate) fn minimise<G: LaneGroup<DOF>, const DOF: usize>(
        self,
        workspace: &mut Workspace<'_, G, DOF>,
        edges: &[Edge<G, DOF>],
        poses: &mut [G],
        options: &Options,
    ) -> Outcome {
        let landmarks = || edges.iter().filter(|edge| edge.kind == EdgeKind::Landmark);
        let largest = landmarks().map(|edge| squared(edge, poses)).fold(0.0, f64::max);
        let priors = workspace.priors.iter().map(|prior| prior.squared(&poses[prior.node]));
        let largest = priors.fold(largest, f64::max);
        let round = Options {
            cost_tolerance: options.cost_tolerance.max(ROUND_TOLERANCE),
            max_iterations: options.max_iterations.min(ROUND_STEPS),
            ..*options
        };
        let mut edges = edges.to_vec();
        let mut before = Outcome::new(f64::NAN);
        for kernel in self.surrogates(largest) {
            set_landmark_kernels(&mut edges, Some(kernel));
            set_prior_kernels(&mut workspace.priors, Some(kernel));
            before = workspace.minimise(&edges, poses, &round).after(&before);
            // The range of weights between 0 and 1 only shrinks: later rounds would give every edge the same weight.
            let decided = |squared: f64| matches!(kernel.evaluate(squared).1, 0.0 | 1.0);
            if before.termination.converged()
                && landmarks().all(|edge| decided(squared(edge, poses)))
                && workspace.priors.iter().all(|prior| decided(prior.squared(&poses[prior.node])))
            {
                break;
            }
        }
        set_landmark_kernels(&mut edges, Some(self.kernel()));
        set_prior_kernels(&mut workspace.priors, Some(self.kernel()));
        workspace.minimise(&edges, poses, options).after(&before)
    }
}

/// The same graph with this kernel on every landmark edge and prior.
pub(crate) fn with_kernels<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    kernel: Option<Kernel>,
) -> Problem<G, DOF> {
    let mut edges = problem.edges().to_vec();
    set_landmark_kernels(&mut edges, kernel);
    let mut priors = problem.priors().to_vec();
    set_prior_kernels(&mut priors, kernel);
    Problem::from_checked(problem.poses().to_vec(), edges, problem.held().to_vec())
        .with_checked_priors(priors)
}

/// Sets this kernel on every landmark edge.
pub(crate) fn set_landmark_kernels<G, const DOF: usize>(edges: &mut [Edge<G, DOF>], kernel: Option<Kernel>) {
    for edge in edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark) {
        edge.kernel = kernel;
    }
}

/// Sets this kernel on every prior.
pub(crate) fn set_prior_kernels<G, const DOF: usize>(priors: &mut [Prior<G, DOF>], kernel: Option<Kernel>) {
    for prior in priors {
        prior.kernel = kernel;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_surrogate_is_convex_up_to_the_largest_residual_and_the_last_is_the_cost() {
        for squared in [30.0, 1e3, 1e7] {
            let surrogates = Graduated::TruncatedLeastSquares(2.0).surrogates(squared);
            assert!(surrogates[0].evaluate(squared).1 > 0.0, "{squared}");
            assert!(
                surrogates.windows(2).all(|pair| pair[0].evaluate(squared).1 >= pair[1].evaluate(squared).1)
            );
            assert_eq!(surrogates[surrogates.len() - 1].evaluate(squared), (4.0, 0.0));
            let surrogates = Graduated::GemanMcClure(2.0).surrogates(squared);
            // rho'' >= 0 in e where s <= c^2 / 3; the paper's start is wider than that.
            assert!(surrogates[0].evaluate(squared).1 > 0.4);
        }
        assert!(Graduated::TruncatedLeastSquares(2.0).surrogates(1.9).is_empty());
        assert!(Graduated::GemanMcClure(2.0).surrogates(1.9).is_empty());
    }
}

//! Graduated non-convexity: outliers set aside without a good start.
//!
//! H. Yang, P. Antonante, V. Tzoumas, L. Carlone, "Graduated non-convexity for robust spatial perception", IEEE RA-L 5(2),
//! 2020. A robust cost is replaced by a convex surrogate, which is minimised, made a little less convex, minimised from
//! there, and so on. The surrogates are kernels ([`Kernel::GemanMcClure`] with a growing width, and
//! [`Kernel::Truncated`]) whose derivatives are the weights of the paper, equations (12) and (14), so that every round is
//! a descent of the surrogate itself rather than an alternation.

use posecut_geometry::LieGroup;

use crate::kernel::Kernel;
use crate::levenberg_marquardt::{Outcome, Workspace};
use crate::normal_equations::Pattern;
use crate::options::Options;
use crate::phases::timed;
use crate::problem::{Edge, EdgeKind};
use crate::residual::squared;

/// Factor between one round's convexity and the next; remark 5 of the paper.
const RATE: f64 = 1.4;
/// Share of the cost below which a round ends: only the last one needs the digits.
pub(crate) const ROUND_TOLERANCE: f64 = 1e-4;
/// Steps per round at most: the next surrogate moves the optimum anyway.
const ROUND_STEPS: usize = 3;
/// Share of its edges that a round's equations are kept for. Below it they are made anew, which costs as much as a few steps.
const MOST_BELIEVED: f64 = 0.9;
/// Rounds after which even a residual of 1e9 widths has been graduated.
const MOST_ROUNDS: usize = 200;

/// The robust cost of landmark edges that graduation ends with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Graduated {
    /// `min(s, c^2)`: an edge is in or out. Parameter c in standard deviations.
    TruncatedLeastSquares(f64),
    /// `s c^2 / (c^2 + s)`. Parameter c in standard deviations.
    GemanMcClure(f64),
}

impl Graduated {
    /// The kernel of the last round.
    pub fn kernel(self) -> Kernel {
        match self {
            Self::TruncatedLeastSquares(width) => Kernel::Truncated { width, convexity: f64::INFINITY },
            Self::GemanMcClure(width) => Kernel::GemanMcClure(width),
        }
    }

    /// The surrogates, most convex first, for squared residuals up to `largest`. Remarks 5 and 6 of the paper:
    /// truncated least squares starts with `mu = c^2 / (2 r^2 - c^2)`, which grows; Geman-McClure with
    /// `mu = 2 r^2 / c^2`, which shrinks to 1.
    fn surrogates(self, largest: f64) -> Vec<Kernel> {
        let mut kernels = Vec::new();
        match self {
            Self::TruncatedLeastSquares(width) => {
                let mut convexity = width * width / (2.0 * largest - width * width);
                // From 1e3 on the surrogate is the cost itself but for a thousandth of the width.
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
    ///
    /// An edge whose weight is zero when a round begins takes no part in it, as in the paper, where weights are constant during a
    /// round. What is factorised is then the graph of the edges still believed, not the far denser one of all.
    pub(crate) fn minimise<G: LieGroup<DOF>, const DOF: usize>(
        self,
        workspace: &mut Workspace<'_, G, DOF>,
        edges: &[Edge<G, DOF>],
        poses: &mut [G],
        options: &Options,
    ) -> Outcome {
        let largest = landmarks(edges).map(|edge| squared(edge, poses)).fold(0.0, f64::max);
        let surrogates = self.surrogates(largest);
        let mut rounds = Rounds {
            left: &surrogates,
            options: Options {
                cost_tolerance: options.cost_tolerance.max(ROUND_TOLERANCE),
                max_iterations: options.max_iterations.min(ROUND_STEPS),
                ..*options
            },
            iterations: 0,
            rejected: 0,
            factorizations: 0,
        };
        while let Some(&kernel) = rounds.left.first() {
            let (believed, others): (Vec<_>, Vec<_>) = edges.iter().partition(|edge| {
                edge.kind != EdgeKind::Landmark || kernel.evaluate(squared(edge, poses)).1 > 0.0
            });
            if believed.len() as f64 > MOST_BELIEVED * edges.len() as f64 {
                rounds.run(workspace, edges.to_vec(), &[], poses);
            } else {
                let phases = &mut workspace.phases;
                let held = workspace.pattern.held;
                let pattern = timed(&mut phases.analysis, || Pattern::of(poses.len(), held, &believed));
                let mut smaller = Workspace::new(&pattern);
                rounds.run(&mut smaller, believed, &others, poses);
                workspace.phases += smaller.phases;
            }
        }
        let mut edges = edges.to_vec();
        set_landmark_kernels(&mut edges, Some(self.kernel()));
        let mut outcome = workspace.minimise(&edges, poses, options);
        outcome.iterations += rounds.iterations;
        outcome.rejected += rounds.rejected;
        outcome.factorizations += rounds.factorizations;
        outcome
    }
}

/// The rounds ahead, and what those behind took.
struct Rounds<'a> {
    left: &'a [Kernel],
    options: Options,
    iterations: usize,
    rejected: usize,
    factorizations: usize,
}

impl Rounds<'_> {
    /// Minimises surrogates over the edges believed, at least one, until another edge has to be believed, or many no longer are.
    fn run<G: LieGroup<DOF>, const DOF: usize>(
        &mut self,
        workspace: &mut Workspace<'_, G, DOF>,
        mut believed: Vec<Edge<G, DOF>>,
        others: &[Edge<G, DOF>],
        poses: &mut [G],
    ) {
        while let Some((&kernel, left)) = self.left.split_first() {
            self.left = left;
            set_landmark_kernels(&mut believed, Some(kernel));
            let outcome = workspace.minimise(&believed, poses, &self.options);
            self.iterations += outcome.iterations;
            self.rejected += outcome.rejected;
            self.factorizations += outcome.factorizations;
            let squares = |edges: &[Edge<G, DOF>]| -> Vec<f64> {
                landmarks(edges).map(|edge| squared(edge, poses)).collect()
            };
            let (inside, outside) = (squares(&believed), squares(others));
            // The range of weights between 0 and 1 only shrinks: later rounds would weigh every edge the same.
            let decided = |squared: &f64| matches!(kernel.evaluate(*squared).1, 0.0 | 1.0);
            if outcome.termination.converged() && inside.iter().chain(&outside).all(decided) {
                self.left = &[];
            }
            let Some(next) = self.left.first() else { return };
            let doubted = |squared: &&f64| next.evaluate(**squared).1 == 0.0;
            let stay = believed.len() - inside.iter().filter(doubted).count();
            if !outside.iter().all(|squared| doubted(&squared))
                || stay as f64 <= MOST_BELIEVED * believed.len() as f64
            {
                return;
            }
        }
    }
}

fn landmarks<G, const DOF: usize>(edges: &[Edge<G, DOF>]) -> impl Iterator<Item = &Edge<G, DOF>> {
    edges.iter().filter(|edge| edge.kind == EdgeKind::Landmark)
}

/// Gives every landmark edge this kernel.
pub(crate) fn set_landmark_kernels<G, const DOF: usize>(edges: &mut [Edge<G, DOF>], kernel: Option<Kernel>) {
    for edge in edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark) {
        edge.kernel = kernel;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;
    use posecut_geometry::SE2;

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

    /// Poses 0 to 3, a metre apart, and a landmark edge that is off by some standard deviations.
    fn rounds_left(error: f64) -> usize {
        let step = SE2::new(1.0, 0.0, 0.0);
        let unit = SMatrix::<f64, 3, 3>::identity();
        let odometry: Vec<_> =
            (0..3).map(|node| Edge::new(node, node + 1, step, unit, EdgeKind::Odometry)).collect();
        let other = Edge::new(0, 3, SE2::new(3.0 + error, 0.0, 0.0), unit, EdgeKind::Landmark);
        let surrogates = [1.0, 2.0, 4.0].map(|convexity| Kernel::Truncated { width: 2.0, convexity });
        let pattern = Pattern::of(4, 1, &odometry);
        let options = Options::default();
        let mut rounds = Rounds { left: &surrogates, options, iterations: 0, rejected: 0, factorizations: 0 };
        let mut poses: Vec<SE2> = (0..4).map(|node| SE2::new(f64::from(node), 0.0, 0.0)).collect();
        rounds.run(&mut Workspace::new(&pattern), odometry, &[other], &mut poses);
        rounds.left.len()
    }

    #[test]
    fn rounds_go_on_without_an_edge_until_it_has_to_be_believed() {
        // The surrogates give no weight from 2.83, 2.45 and 2.24 standard deviations on.
        assert_eq!(rounds_left(9.0), 0);
        assert_eq!(rounds_left(2.3), 2);
    }
}

//! Groups of poses that can be optimised: SE(2) and SE(3).
//!
//! Beyond [`LieGroup`], the two differ in the order of the blocks of the relaxation and of the certificate. The solver and the
//! covariances are methods of the group too: so they are compiled here once for each group, and not again in every crate that
//! calls the generic functions. Depends on [`initialisation`](crate::initialisation), `certificate`, `lifted`, `batch` and `covariance`.

use posecut_cholesky::{Memory, MixedFactor};
use posecut_geometry::{SE2, SE3};

use crate::batch::solution::Solution;
use crate::batch::solve::optimize_and_keep;
use crate::certificate::{self, Certificate};
use crate::covariance::at_solution;
use crate::covariance::marginals::{Joint, Marginals};
use crate::effort::Effort;
use crate::initialisation::{alignment, chordal, windings};
use crate::lifted;
use crate::model::lanes::LaneGroup;
use crate::model::prior::Prior;
use crate::model::problem::{Edge, Problem};
use crate::normal_equations::Pattern;
use crate::options::Options;

/// A group of poses that can be optimised, with its chordal relaxation.
pub trait PoseGroup<const DOF: usize>: LaneGroup<DOF> {
    /// Poses of a connected graph by the chordal relaxation, rotations first, with its first poses given; `None` if the edges
    /// do not determine them. If no pose is given, that of the first node is `anchor`.
    #[doc(hidden)]
    fn chordal_poses(
        memory: &mut Relaxation<'_, DOF>,
        edges: &[Edge<Self, DOF>],
        held: &[Self],
        anchor: &Self,
    ) -> Option<Vec<Self>>;

    /// Whether poses surely lie in the basin of rotations that the cycles of the edges point to. In space, never.
    #[doc(hidden)]
    fn is_unwound(edges: &[Edge<Self, DOF>], poses: &[Self]) -> bool;

    /// The rigid motion that moves poses to their priors.
    #[doc(hidden)]
    fn aligning(priors: &[Prior<Self, DOF>], poses: &[Self]) -> Self;

    /// Poses of a connected graph near the minimum of SE-Sync's cost in more dimensions, found from these poses: one projection of it if the
    /// relaxation is tight, and several otherwise; `None` if that cost does not exist. Ends early once the effort is spent.
    #[doc(hidden)]
    fn lifted_poses(edges: &[Edge<Self, DOF>], poses: &[Self], effort: &mut Effort)
    -> Option<Vec<Vec<Self>>>;

    /// The certificate of a connected graph, and the poses it is for.
    #[doc(hidden)]
    fn certificate(edges: &[Edge<Self, DOF>], poses: &[Self]) -> (Certificate, Vec<Self>);

    /// The body of [`optimize`](crate::optimize).
    #[doc(hidden)]
    fn solve(problem: &Problem<Self, DOF>, options: &Options) -> Solution<Self>;

    /// The body of [`optimize_with_marginals`](crate::optimize_with_marginals).
    #[doc(hidden)]
    fn solve_with_marginals(
        problem: &Problem<Self, DOF>,
        options: &Options,
        memory: Vec<Memory>,
    ) -> (Solution<Self>, Marginals<Self, DOF>);

    /// The body of [`Marginals::new`].
    #[doc(hidden)]
    fn marginals(problem: &Problem<Self, DOF>, poses: &[Self], weights: &[f64]) -> Marginals<Self, DOF>;

    /// The body of [`Marginals::joint`].
    #[doc(hidden)]
    fn joint(marginals: &mut Marginals<Self, DOF>, pairs: &[(usize, usize)]) -> Vec<Option<Joint<DOF>>>;
}

/// The methods whose bodies do not depend on the group.
macro_rules! compile_here {
    ($freedom:literal) => {
        fn solve(problem: &Problem<Self, $freedom>, options: &Options) -> Solution<Self> {
            optimize_and_keep(problem, options, Vec::new(), |_| ())
        }

        fn solve_with_marginals(
            problem: &Problem<Self, $freedom>,
            options: &Options,
            memory: Vec<Memory>,
        ) -> (Solution<Self>, Marginals<Self, $freedom>) {
            at_solution::solve_with_marginals(problem, options, memory)
        }

        fn marginals(
            problem: &Problem<Self, $freedom>,
            poses: &[Self],
            weights: &[f64],
        ) -> Marginals<Self, $freedom> {
            Marginals::of(problem, poses, weights, Vec::new())
        }

        fn joint(
            marginals: &mut Marginals<Self, $freedom>,
            pairs: &[(usize, usize)],
        ) -> Vec<Option<Joint<$freedom>>> {
            marginals.joint_here(pairs)
        }
    };
}

/// The parts of the normal equations that the relaxation uses: their pattern, and the memory of their factor.
#[doc(hidden)]
#[derive(Debug)]
pub struct Relaxation<'a, const DOF: usize> {
    pub(crate) pattern: &'a Pattern,
    pub(crate) factor: &'a mut MixedFactor<DOF>,
}

impl PoseGroup<3> for SE2 {
    fn chordal_poses(
        memory: &mut Relaxation<'_, 3>,
        edges: &[Edge<Self, 3>],
        held: &[Self],
        anchor: &Self,
    ) -> Option<Vec<Self>> {
        let pattern = memory.pattern;
        memory.factor.lend(|factor| chordal::poses::<Self, 3, 2>(pattern, edges, held, anchor, factor))
    }

    fn is_unwound(edges: &[Edge<Self, 3>], poses: &[Self]) -> bool {
        windings::is_unwound(edges, poses)
    }

    fn aligning(priors: &[Prior<Self, 3>], poses: &[Self]) -> Self {
        alignment::aligning::<Self, 3, 2>(priors, poses)
    }

    fn lifted_poses(edges: &[Edge<Self, 3>], poses: &[Self], effort: &mut Effort) -> Option<Vec<Vec<Self>>> {
        lifted::lifted_poses::<Self, 3, 2, 3, 4, 9>(edges, poses, effort)
    }

    fn certificate(edges: &[Edge<Self, 3>], poses: &[Self]) -> (Certificate, Vec<Self>) {
        certificate::certify::<Self, 3, 2, 3>(edges, poses)
    }

    compile_here!(3);
}

impl PoseGroup<6> for SE3 {
    fn chordal_poses(
        memory: &mut Relaxation<'_, 6>,
        edges: &[Edge<Self, 6>],
        held: &[Self],
        anchor: &Self,
    ) -> Option<Vec<Self>> {
        let pattern = memory.pattern;
        memory.factor.lend(|factor| chordal::poses::<Self, 6, 3>(pattern, edges, held, anchor, factor))
    }

    fn is_unwound(_: &[Edge<Self, 6>], _: &[Self]) -> bool {
        false
    }

    fn aligning(priors: &[Prior<Self, 6>], poses: &[Self]) -> Self {
        alignment::aligning::<Self, 6, 3>(priors, poses)
    }

    fn lifted_poses(edges: &[Edge<Self, 6>], poses: &[Self], effort: &mut Effort) -> Option<Vec<Vec<Self>>> {
        lifted::lifted_poses::<Self, 6, 3, 4, 5, 14>(edges, poses, effort)
    }

    fn certificate(edges: &[Edge<Self, 6>], poses: &[Self]) -> (Certificate, Vec<Self>) {
        certificate::certify::<Self, 6, 3, 4>(edges, poses)
    }

    compile_here!(6);
}

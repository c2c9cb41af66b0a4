//! Groups of poses that can be optimised incrementally: SE(2) and SE(3).
//!
//! The long methods of the solver are methods of the group too: so they are compiled here once for each group, and not again in
//! every crate, test and example that calls them. Depends on [`PoseGroup`] and on the solver.

use nalgebra::SMatrix;
use posecut_geometry::{SE2, SE3};
use posecut_optimize::{Edge, PoseGroup};

use crate::{EdgeId, FinishReport, IncrementalError, IncrementalSolver, UpdateReport};

/// A group of poses that can be optimised incrementally.
pub trait IncrementalGroup<const DOF: usize>: PoseGroup<DOF> {
    /// The body of [`IncrementalSolver::add_edge`].
    #[doc(hidden)]
    fn add_edge(
        solver: &mut IncrementalSolver<Self, DOF>,
        edge: Edge<Self, DOF>,
    ) -> Result<EdgeId, IncrementalError>;

    /// The body of [`IncrementalSolver::remove_edge`].
    #[doc(hidden)]
    fn remove_edge(
        solver: &mut IncrementalSolver<Self, DOF>,
        id: EdgeId,
    ) -> Result<Edge<Self, DOF>, IncrementalError>;

    /// The body of [`IncrementalSolver::cost`].
    #[doc(hidden)]
    fn cost(solver: &IncrementalSolver<Self, DOF>) -> f64;

    /// The body of [`IncrementalSolver::update`].
    #[doc(hidden)]
    fn update(solver: &mut IncrementalSolver<Self, DOF>) -> UpdateReport;

    /// The body of [`IncrementalSolver::relinearise_all`].
    #[doc(hidden)]
    fn relinearise_all(solver: &mut IncrementalSolver<Self, DOF>) -> (f64, UpdateReport);

    /// The body of [`IncrementalSolver::finish`].
    #[doc(hidden)]
    fn finish(solver: &mut IncrementalSolver<Self, DOF>) -> FinishReport;

    /// The body of [`IncrementalSolver::restart`].
    #[doc(hidden)]
    fn restart(solver: &mut IncrementalSolver<Self, DOF>) -> bool;

    /// The body of [`IncrementalSolver::marginalise`].
    #[doc(hidden)]
    fn marginalise(
        solver: &mut IncrementalSolver<Self, DOF>,
        poses: &[usize],
    ) -> Result<(), IncrementalError>;

    /// The body of [`IncrementalSolver::marginalise_before`].
    #[doc(hidden)]
    fn marginalise_before(solver: &mut IncrementalSolver<Self, DOF>, end: usize) -> usize;

    /// The body of [`IncrementalSolver::covariance`].
    #[doc(hidden)]
    fn covariance(solver: &IncrementalSolver<Self, DOF>, pose: usize) -> Option<SMatrix<f64, DOF, DOF>>;
}

macro_rules! compile_here {
    ($group:ty, $freedom:literal) => {
        impl IncrementalGroup<$freedom> for $group {
            fn add_edge(
                solver: &mut IncrementalSolver<Self, $freedom>,
                edge: Edge<Self, $freedom>,
            ) -> Result<EdgeId, IncrementalError> {
                solver.add_edge_here(edge)
            }

            fn remove_edge(
                solver: &mut IncrementalSolver<Self, $freedom>,
                id: EdgeId,
            ) -> Result<Edge<Self, $freedom>, IncrementalError> {
                solver.remove_edge_here(id)
            }

            fn cost(solver: &IncrementalSolver<Self, $freedom>) -> f64 {
                solver.cost_at(|node| solver.estimate(node))
            }

            fn update(solver: &mut IncrementalSolver<Self, $freedom>) -> UpdateReport {
                solver.update_here()
            }

            fn relinearise_all(solver: &mut IncrementalSolver<Self, $freedom>) -> (f64, UpdateReport) {
                solver.relinearise_all_here()
            }

            fn finish(solver: &mut IncrementalSolver<Self, $freedom>) -> FinishReport {
                solver.finish_here()
            }

            fn restart(solver: &mut IncrementalSolver<Self, $freedom>) -> bool {
                solver.fresh_start().is_better
            }

            fn marginalise(
                solver: &mut IncrementalSolver<Self, $freedom>,
                poses: &[usize],
            ) -> Result<(), IncrementalError> {
                solver.marginalise_here(poses)
            }

            fn marginalise_before(solver: &mut IncrementalSolver<Self, $freedom>, end: usize) -> usize {
                solver.marginalise_before_here(end)
            }

            fn covariance(
                solver: &IncrementalSolver<Self, $freedom>,
                pose: usize,
            ) -> Option<SMatrix<f64, $freedom, $freedom>> {
                solver.covariance_here(pose)
            }
        }
    };
}

compile_here!(SE2, 3);
compile_here!(SE3, 6);

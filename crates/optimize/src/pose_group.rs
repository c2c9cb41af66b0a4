//! Groups of poses that can be optimised: SE(2) and SE(3).
//!
//! Beyond [`LieGroup`], the two differ in the order of the blocks of the relaxation and of the certificate. Depends on
//! [`initialisation`](crate::initialisation) and on `certificate`.

use posecut_cholesky::Factor;
use posecut_geometry::{LieGroup, SE2, SE3};

use crate::certificate::{self, Certificate};
use crate::initialisation::chordal;
use crate::model::problem::Edge;
use crate::normal_equations::Pattern;

/// A group of poses that can be optimised, with its chordal relaxation.
pub trait PoseGroup<const DOF: usize>: LieGroup<DOF> {
    /// Poses of a connected graph by the chordal relaxation, rotations first, with its first poses given; `None` if the edges
    /// do not determine them.
    #[doc(hidden)]
    fn chordal_poses(
        memory: &mut Relaxation<'_, DOF>,
        edges: &[Edge<Self, DOF>],
        held: &[Self],
    ) -> Option<Vec<Self>>;

    /// The certificate of a connected graph.
    #[doc(hidden)]
    fn certificate(edges: &[Edge<Self, DOF>], poses: &[Self]) -> Certificate;
}

/// The parts of the normal equations that the relaxation uses: their pattern, and the memory of their factor.
#[doc(hidden)]
#[derive(Debug)]
pub struct Relaxation<'a, const DOF: usize> {
    pub(crate) pattern: &'a Pattern,
    pub(crate) factor: &'a mut Factor<DOF>,
}

impl PoseGroup<3> for SE2 {
    fn chordal_poses(
        memory: &mut Relaxation<'_, 3>,
        edges: &[Edge<Self, 3>],
        held: &[Self],
    ) -> Option<Vec<Self>> {
        let pattern = memory.pattern;
        memory.factor.lend(|factor| chordal::poses::<Self, 3, 2>(pattern, edges, held, factor))
    }

    fn certificate(edges: &[Edge<Self, 3>], poses: &[Self]) -> Certificate {
        certificate::certify::<Self, 3, 2, 3>(edges, poses)
    }
}

impl PoseGroup<6> for SE3 {
    fn chordal_poses(
        memory: &mut Relaxation<'_, 6>,
        edges: &[Edge<Self, 6>],
        held: &[Self],
    ) -> Option<Vec<Self>> {
        let pattern = memory.pattern;
        memory.factor.lend(|factor| chordal::poses::<Self, 6, 3>(pattern, edges, held, factor))
    }

    fn certificate(edges: &[Edge<Self, 6>], poses: &[Self]) -> Certificate {
        certificate::certify::<Self, 6, 3, 4>(edges, poses)
    }
}

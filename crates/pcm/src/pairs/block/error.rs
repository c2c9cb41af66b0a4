//! The error of the loops through a candidate and each lane of a register.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use pulp::Simd;

use super::{Block, Row};
use crate::odometry::spread::Spatial;
use crate::pairs::logarithm::logarithm;
use posecut_geometry::lanes::Lanes;

impl<const DOF: usize> Row<'_, DOF> {
    /// Log(T_a^-1 T_b).
    #[inline(always)]
    pub(super) fn error<G: Spatial<DOF>, S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        asked: u64,
    ) -> [Lanes<S>; DOF] {
        let [w, x, y, z] = Lanes::load_four(simd, &block.quaternion, first);
        let [ow, ox, oy, oz] = self.turn.quaternion;
        // The conjugate of the row's quaternion times the block's.
        let quaternion = [
            w * ow + x * ox + y * oy + z * oz,
            x * ow - w * ox - z * oy + y * oz,
            y * ow + z * ox - w * oy - x * oz,
            z * ow - y * ox + x * oy - w * oz,
        ];
        let mut apart = Lanes::load_three(simd, &block.translation, first);
        for (axis, apart) in apart.iter_mut().enumerate() {
            *apart = *apart - Lanes::splat(simd, self.place.translation[axis]);
        }
        let rotation = &self.place.rotation;
        let mut translation = apart;
        for (axis, term) in translation.iter_mut().enumerate() {
            *term = apart[0] * rotation[(0, axis)]
                + apart[1] * rotation[(1, axis)]
                + apart[2] * rotation[(2, axis)];
        }
        let (straight, turned) = logarithm(simd, translation, quaternion, asked);
        let whole = [straight[0], straight[1], straight[2], turned[0], turned[1], turned[2]];
        let mut error = [whole[0]; DOF];
        for (term, axis) in error.iter_mut().zip(G::AXES) {
            *term = whole[axis];
        }
        error
    }
}

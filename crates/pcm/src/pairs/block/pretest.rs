//! The pre-test of a register's lanes.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use pulp::Simd;

use super::{Block, Row};
use crate::pairs::pretest::SLACK;
use posecut_geometry::lanes::{Lanes, Mask};

impl<const DOF: usize> Row<'_, DOF> {
    /// The pre-test of rotations.
    #[inline(always)]
    pub(super) fn turned_apart<S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        gate: f64,
        doubled: f64,
    ) -> Mask<S> {
        let splat = |value: f64| Lanes::splat(simd, value);
        let [w, x, y, z] = Lanes::load_four(simd, &block.quaternion, first);
        let q = self.turn.quaternion;
        let half_cosine = w * q[0] + x * q[1] + y * q[2] + z * q[3];
        let turned = (splat(1.0) - half_cosine * half_cosine) * 4.0;
        let [own, a, b] = Lanes::load_three(simd, &block.turns, first);
        let stretches = (a - splat(self.turn.a)).abs() + (b - splat(self.turn.b)).abs();
        let bound = own + splat(self.turn.own) + stretches * doubled;
        (bound * (gate * SLACK)).less_than(turned)
    }

    /// The pre-test of positions.
    #[inline(always)]
    pub(super) fn shifted_apart<S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        gate: f64,
        doubled: f64,
    ) -> Mask<S> {
        let splat = |value: f64| Lanes::splat(simd, value);
        let (point, claimed) = (&self.place.point, &self.place.claimed);
        let mut shifted = splat(0.0);
        for axis in 0..3 {
            let [x, y, z] = Lanes::load_three(simd, &block.rotation[axis], first);
            let there = x * point.x + y * point.y + z * point.z;
            let shift = there + Lanes::load(simd, &block.translation[axis], first) - splat(claimed[axis]);
            shifted = shifted + shift * shift;
        }
        let [own, a, b] = self.spreads;
        let stretches = (block.spreads[1].at(simd, first, claimed) - splat(a)).abs()
            + (block.spreads[2].at(simd, first, point) - splat(b)).abs();
        let bound = block.spreads[0].at(simd, first, point) + splat(own) + stretches * doubled;
        (bound * (gate * SLACK)).less_than(shifted)
    }
}

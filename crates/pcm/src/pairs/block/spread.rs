//! Spreads of a block's candidates.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use nalgebra::Vector3;
use pulp::Simd;

use crate::odometry::spread::Spread;
use posecut_geometry::lanes::{Lanes, Wide};

#[derive(Clone, Copy, Default)]
pub(super) struct WideSpread {
    translation: Wide,
    lever: [Wide; 3],
    rotation: [Wide; 6],
}

impl WideSpread {
    pub(super) fn set(&mut self, lane: usize, spread: &Spread) {
        self.translation.0[lane] = spread.translation;
        for (wide, value) in self.lever.iter_mut().zip(spread.lever) {
            wide.0[lane] = value;
        }
        for (wide, value) in self.rotation.iter_mut().zip(spread.rotation) {
            wide.0[lane] = value;
        }
    }

    /// As [`Spread::at`].
    #[inline(always)]
    pub(super) fn at<S: Simd>(&self, simd: S, first: usize, q: &Vector3<f64>) -> Lanes<S> {
        let load = |wide: &Wide| Lanes::load(simd, wide, first);
        let [xx, yy, zz, xy, xz, yz] = &self.rotation;
        let lever = Lanes::load_three(simd, &self.lever, first);
        load(&self.translation)
            + (lever[0] * q.x + lever[1] * q.y + lever[2] * q.z) * 2.0
            + (load(xx) * q.x + (load(xy) * q.y + load(xz) * q.z) * 2.0) * q.x
            + (load(yy) * q.y + load(yz) * (2.0 * q.z)) * q.y
            + load(zz) * (q.z * q.z)
    }
}

//! Several edges at once: one edge in each lane of a vector register.
//!
//! The products of one edge are small matrices, which fill no register; the same product of four edges does. Residuals, Jacobians and
//! blocks are those of [`residual`](super::residual), in the group's own closed forms: `planar` and `spatial`. Where an error turns by more
//! than [`half_angle`] covers, the caller computes these edges one by one.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

mod even;
mod half_angle;
mod planar;
mod rotation;
mod spatial;
mod vector;

use faer::traits::pulp::Simd;
use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_geometry::lanes::{Lanes, WIDTH};

use super::kernel::charge;
use super::problem::Edge;
use super::quadratic::{Gradient, Linearised};

/// A group whose edges can be evaluated several at once: as many as `S` has lanes, or fewer. The results are written in the order of the
/// edges; `false` means that nothing was computed, because an error turns too far.
pub trait LaneGroup<const DOF: usize>: LieGroup<DOF> {
    /// The costs of edges.
    fn costs<S: Simd>(simd: S, edges: &[Edge<Self, DOF>], poses: &[Self], costs: &mut [f64]) -> bool;

    /// The linear models of edges.
    fn gradients<S: Simd>(
        simd: S,
        edges: &[Edge<Self, DOF>],
        poses: &[Self],
        gradients: &mut [Gradient<DOF>],
    ) -> bool;

    /// The quadratic models of edges.
    fn models<S: Simd>(
        simd: S,
        edges: &[Edge<Self, DOF>],
        poses: &[Self],
        models: &mut [Linearised<DOF>],
    ) -> bool;

    /// The poses moved apart by each step: `X (I, v) Exp(0, r)`.
    fn moved<S: Simd>(simd: S, poses: &[Self], steps: &[SVector<f64, DOF>], moved: &mut [Self]) -> bool;
}

/// The edges of the lanes, and the poses of their ends. A lane without an edge repeats the last one.
struct Ends<'a, G, const DOF: usize> {
    edges: &'a [Edge<G, DOF>],
    poses: &'a [G],
}

impl<'a, G, const DOF: usize> Ends<'a, G, DOF> {
    #[inline(always)]
    fn edge(&self, lane: usize) -> &'a Edge<G, DOF> {
        &self.edges[lane.min(self.edges.len() - 1)]
    }

    /// A number of each edge.
    #[inline(always)]
    fn of_edge<S: Simd>(&self, simd: S, number: impl Fn(&Edge<G, DOF>) -> f64) -> Lanes<S> {
        Lanes::gather(simd, |lane| number(self.edge(lane)))
    }

    /// A number of each edge's first pose.
    #[inline(always)]
    fn of_from<S: Simd>(&self, simd: S, number: impl Fn(&G) -> f64) -> Lanes<S> {
        Lanes::gather(simd, |lane| number(&self.poses[self.edge(lane).from]))
    }

    /// A number of each edge's second pose.
    #[inline(always)]
    fn of_to<S: Simd>(&self, simd: S, number: impl Fn(&G) -> f64) -> Lanes<S> {
        Lanes::gather(simd, |lane| number(&self.poses[self.edge(lane).to]))
    }

    /// An entry of each edge's information.
    #[inline(always)]
    fn information<S: Simd>(&self, simd: S, row: usize, column: usize) -> Lanes<S> {
        self.of_edge(simd, |edge| edge.information[(row, column)])
    }

    /// The costs for these squared residuals, and the weights unless all are 1.
    #[inline(always)]
    fn charge<S: Simd>(&self, simd: S, squared: &Lanes<S>) -> ([f64; WIDTH], Option<Lanes<S>>) {
        let mut costs = [0.0; WIDTH];
        for (cost, &squared) in costs.iter_mut().zip(squared.numbers()) {
            *cost = squared;
        }
        if self.edges.iter().all(|edge| edge.kernel.is_none()) {
            return (costs, None);
        }
        let mut weights = [1.0; WIDTH];
        for (edge, (cost, weight)) in self.edges.iter().zip(costs.iter_mut().zip(&mut weights)) {
            (*cost, *weight) = charge(edge.kernel, *cost);
        }
        (costs, Some(Lanes::gather(simd, |lane| weights[lane])))
    }
}

/// The quadratic models of the lanes' edges, which [`Linearised`] describes; the columns of each block. The costs are not among them.
struct Models<S: Simd, const DOF: usize> {
    from_from: [[Lanes<S>; DOF]; DOF],
    from_to: [[Lanes<S>; DOF]; DOF],
    to_to: [[Lanes<S>; DOF]; DOF],
    from_gradient: [Lanes<S>; DOF],
    to_gradient: [Lanes<S>; DOF],
}

impl<S: Simd, const DOF: usize> Models<S, DOF> {
    /// Writes the model of every lane, with its cost.
    #[inline(always)]
    fn write(&self, costs: &[f64; WIDTH], models: &mut [Linearised<DOF>]) {
        write_block(&self.from_from, models, |model| &mut model.from_from);
        write_block(&self.from_to, models, |model| &mut model.from_to);
        write_block(&self.to_to, models, |model| &mut model.to_to);
        for (lane, model) in models.iter_mut().enumerate() {
            write(&self.from_gradient, lane, model.from_gradient.as_mut_slice());
            write(&self.to_gradient, lane, model.to_gradient.as_mut_slice());
            model.cost = costs[lane];
        }
    }
}

/// Writes a block of every lane's model.
#[inline(always)]
fn write_block<S: Simd, const DOF: usize>(
    columns: &[[Lanes<S>; DOF]; DOF],
    models: &mut [Linearised<DOF>],
    block: impl Fn(&mut Linearised<DOF>) -> &mut SMatrix<f64, DOF, DOF>,
) {
    let lanes = columns.as_flattened();
    let (squares, _) = lanes.as_chunks::<4>();
    let mut written = 0;
    // Four numbers of four lanes are transposed in registers.
    if S::F64_LANES == 4 && models.len() == 4 {
        for square in squares {
            for (model, row) in models.iter_mut().zip(Lanes::transposed(square)) {
                block(model).as_mut_slice()[written..written + 4].copy_from_slice(row.numbers());
            }
            written += 4;
        }
    }
    for (lane, model) in models.iter_mut().enumerate() {
        write(&lanes[written..], lane, &mut block(model).as_mut_slice()[written..]);
    }
}

/// Writes the linear model of every lane.
#[inline(always)]
fn write_gradients<S: Simd, const DOF: usize>(
    (from, to): (&[Lanes<S>; DOF], &[Lanes<S>; DOF]),
    costs: &[f64; WIDTH],
    gradients: &mut [Gradient<DOF>],
) {
    for (lane, gradient) in gradients.iter_mut().enumerate() {
        write(from, lane, gradient.from.as_mut_slice());
        write(to, lane, gradient.to.as_mut_slice());
        gradient.cost = costs[lane];
    }
}

/// Writes the numbers of one lane.
#[inline(always)]
fn write<S: Simd>(lanes: &[Lanes<S>], lane: usize, numbers: &mut [f64]) {
    for (number, of) in numbers.iter_mut().zip(lanes) {
        *number = of.numbers()[lane];
    }
}

/// The array of a value for the indices 0, 1 and 2. `map` would call its closure, which has no vector instructions.
macro_rules! three {
    ($index:ident => $value:expr) => {
        [
            {
                let $index = 0;
                $value
            },
            {
                let $index = 1;
                $value
            },
            {
                let $index = 2;
                $value
            },
        ]
    };
}
use three;

#[cfg(test)]
mod tests;

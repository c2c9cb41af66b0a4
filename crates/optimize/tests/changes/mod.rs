//! Graphs with the same solution: other units, scales, numbering, directions, frames, copies, and unconnected graphs.

#![allow(clippy::unwrap_used, reason = "support of tests")]

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_optimize::{Edge, PoseGroup};

/// Poses and edges.
pub(crate) type Graph<G, const DOF: usize> = (Vec<G>, Vec<Edge<G, DOF>>);

pub(crate) fn scaled<G: LieGroup<DOF>, const DOF: usize>(pose: &G, unit: f64) -> G {
    let mut components = pose.components();
    components[..if DOF == 6 { 3 } else { 2 }].iter_mut().for_each(|component| *component *= unit);
    G::from_components(&components).unwrap()
}

/// The same graph with `unit` units of length per metre.
pub(crate) fn in_units<G: LieGroup<DOF>, const DOF: usize>(
    unit: f64,
    (poses, edges): &Graph<G, DOF>,
) -> Graph<G, DOF> {
    let translations = if DOF == 6 { 3 } else { 2 };
    let shrink =
        SMatrix::from_diagonal(&SVector::from_fn(
            |axis, _| if axis < translations { 1.0 / unit } else { 1.0 },
        ));
    let edge = |edge: &Edge<G, DOF>| Edge {
        measurement: scaled(&edge.measurement, unit),
        information: shrink * edge.information * shrink,
        ..*edge
    };
    (poses.iter().map(|pose| scaled(pose, unit)).collect(), edges.iter().map(edge).collect())
}

/// The same graph with other information.
pub(crate) fn with_information_times<G: LieGroup<DOF>, const DOF: usize>(
    factor: f64,
    (poses, edges): &Graph<G, DOF>,
) -> Graph<G, DOF> {
    let edge = |edge: &Edge<G, DOF>| Edge { information: edge.information * factor, ..*edge };
    (poses.clone(), edges.iter().map(edge).collect())
}

/// The largest component of the difference between two lists of poses, relative to their first poses.
pub(crate) fn largest_gap<G: LieGroup<DOF>, const DOF: usize>(one: &[G], other: &[G]) -> f64 {
    let seen = |poses: &[G], node: usize| poses[0].between(&poses[node]);
    (0..one.len()).map(|node| seen(one, node).between(&seen(other, node)).log().amax()).fold(0.0, f64::max)
}

/// A changed graph, the new index of every node, the new length of a metre and of a standard deviation.
pub(crate) struct Changed<G, const DOF: usize> {
    pub(crate) name: &'static str,
    pub(crate) graph: Graph<G, DOF>,
    pub(crate) places: Vec<usize>,
    pub(crate) unit: f64,
    #[allow(dead_code, reason = "not every test has kernels")]
    pub(crate) deviation: f64,
}

pub(crate) fn changes<G: PoseGroup<DOF>, const DOF: usize>(graph: &Graph<G, DOF>) -> Vec<Changed<G, DOF>> {
    let (poses, edges) = graph;
    let count = poses.len();
    let same: Vec<usize> = (0..count).collect();
    let change = |name, graph, places: &[usize], unit, deviation| Changed {
        name,
        graph,
        places: places.to_vec(),
        unit,
        deviation,
    };
    // A stride that has no divisor in common with the number of nodes.
    let permuted: Vec<usize> = (0..count).map(|node| (node * 37 + 11) % count).collect();
    let mut moved_poses = poses.clone();
    for (node, &place) in permuted.iter().enumerate() {
        moved_poses[place] = poses[node];
    }
    let renumber = |edge: &Edge<G, DOF>| Edge { from: permuted[edge.from], to: permuted[edge.to], ..*edge };
    // Z^-1 has the error -Ad(Z) e.
    let reverse = |edge: &Edge<G, DOF>| {
        let back = edge.measurement.inverse();
        let adjoint = back.adjoint();
        let information = adjoint.transpose() * edge.information * adjoint;
        Edge {
            from: edge.to,
            to: edge.from,
            measurement: back,
            information: (information + information.transpose()) * 0.5,
            ..*edge
        }
    };
    let every_other =
        |(place, edge): (usize, &Edge<G, DOF>)| if place % 2 == 0 { reverse(edge) } else { *edge };
    let motion = G::exp(&SVector::from_fn(|axis, _| 3.0 - 1.3 * axis as f64));
    let twice: Vec<Edge<G, DOF>> =
        edges.iter().flat_map(|edge| [Edge { information: edge.information * 0.5, ..*edge }; 2]).collect();
    let apart = |edge: &Edge<G, DOF>| Edge { from: edge.from + count, to: edge.to + count, ..*edge };
    let backwards = edges.iter().rev().copied().collect();
    vec![
        change("millimetres", in_units(1e3, graph), &same, 1e3, 1.0),
        change("kilometres", in_units(1e-3, graph), &same, 1e-3, 1.0),
        change("information times 1e-12", with_information_times(1e-12, graph), &same, 1.0, 1e-6),
        change("information times 1e12", with_information_times(1e12, graph), &same, 1.0, 1e6),
        change("nodes permuted", (moved_poses, edges.iter().map(renumber).collect()), &permuted, 1.0, 1.0),
        change("edges in reverse order", (poses.clone(), backwards), &same, 1.0, 1.0),
        change("edges reversed", (poses.clone(), edges.iter().map(reverse).collect()), &same, 1.0, 1.0),
        change(
            "every other edge reversed",
            (poses.clone(), edges.iter().enumerate().map(every_other).collect()),
            &same,
            1.0,
            1.0,
        ),
        change(
            "a rigid motion",
            (poses.iter().map(|pose| motion.compose(pose)).collect(), edges.clone()),
            &same,
            1.0,
            1.0,
        ),
        // Kernels see two edges with half the square each: graduation then solves a different problem.
        change("every edge twice with half the information", (poses.clone(), twice), &same, 1.0, f64::NAN),
        change(
            "another session without connection",
            (
                poses.iter().chain(poses).copied().collect(),
                edges.iter().copied().chain(edges.iter().map(apart)).collect(),
            ),
            &same,
            1.0,
            1.0,
        ),
    ]
}

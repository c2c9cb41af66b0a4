//! Lower bounds on distances, from the distances to a few far nodes.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use crate::graph::kernel::Kernel;

/// Kernels with fewer nodes are searched without bounds.
const WORTHWHILE: usize = 300;

/// Distances from two nodes at opposite ends of a kernel. By the triangle inequality, two nodes are at least as far apart as
/// their distances from either differ (Goldberg, Harrelson, SODA 2005, "ALT"). In a band, which results when one session
/// follows another along its whole length, this bound is nearly the distance itself, and a path search hardly looks elsewhere.
#[derive(Debug, Clone, Default)]
pub(crate) struct LandmarkDistances {
    /// Two nodes, and distances from each; none for small kernels.
    from: Vec<(u32, Vec<f32>)>,
}

impl LandmarkDistances {
    /// Distances by the number of attractive edges.
    pub(crate) fn hops(kernel: &Kernel) -> Self {
        if kernel.node_count() < WORTHWHILE {
            return Self { from: Vec::new() };
        }
        let farthest = |distances: &[f32]| {
            let near = |a: &f32, b: &f32| a.total_cmp(b);
            let reached = distances.iter().enumerate().filter(|(_, distance)| distance.is_finite());
            reached.max_by(|a, b| near(a.1, b.1).then(b.0.cmp(&a.0))).map_or(0, |(node, _)| node as u32)
        };
        let first = farthest(&hops_from(kernel, 0));
        let distances = hops_from(kernel, first);
        let second = farthest(&distances);
        let opposite = hops_from(kernel, second);
        Self { from: vec![(first, distances), (second, opposite)] }
    }

    /// Replaces the distances by those for new lengths of the attractive edges, from the same nodes.
    pub(crate) fn update(&mut self, kernel: &Kernel, length: impl Fn(u32) -> f64) {
        for (node, distances) in &mut self.from {
            *distances = distances_from(kernel, *node, &length);
        }
    }

    /// A lower bound on the distance between two nodes, up to rounding.
    pub(crate) fn at_least(&self, first: u32, second: u32) -> f32 {
        // Infinity minus infinity is NaN, which `max` ignores.
        self.from
            .iter()
            .map(|(_, distances)| (distances[first as usize] - distances[second as usize]).abs())
            .fold(0.0, f32::max)
    }
}

fn hops_from(kernel: &Kernel, source: u32) -> Vec<f32> {
    let mut distances = vec![f32::INFINITY; kernel.node_count()];
    distances[source as usize] = 0.0;
    let mut queue = VecDeque::from([source]);
    while let Some(node) = queue.pop_front() {
        for &(other, edge) in kernel.arcs(node) {
            if kernel.costs[edge as usize] > 0.0 && distances[other as usize] == f32::INFINITY {
                distances[other as usize] = distances[node as usize] + 1.0;
                queue.push_back(other);
            }
        }
    }
    distances
}

fn distances_from(kernel: &Kernel, source: u32, length: &impl Fn(u32) -> f64) -> Vec<f32> {
    let mut distances = vec![f64::INFINITY; kernel.node_count()];
    distances[source as usize] = 0.0;
    let mut heap = BinaryHeap::from([Reverse((0, source))]);
    while let Some(Reverse((bits, node))) = heap.pop() {
        let distance = f64::from_bits(bits);
        if distance > distances[node as usize] {
            continue;
        }
        for &(other, edge) in kernel.arcs(node) {
            let next = distance + length(edge);
            if kernel.costs[edge as usize] > 0.0 && next < distances[other as usize] {
                distances[other as usize] = next;
                heap.push(Reverse((next.to_bits(), other)));
            }
        }
    }
    distances.into_iter().map(|distance| distance as f32).collect()
}

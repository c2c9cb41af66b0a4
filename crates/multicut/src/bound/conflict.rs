//! Conflicts: cycles and odd wheels for which every multicut must pay.

use crate::graph::kernel::Kernel;

/// An inequality in the payments of edges: `y` for an attractive edge, `1 - y` for a repulsive one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Conflict {
    /// A cycle with exactly one repulsive edge, which joins the last node to the first. Its edges are paid 1 or more in total.
    Cycle(Vec<u32>),
    /// Edges around and towards a node.
    Wheel(Wheel),
    /// Edges among and between two sets of nodes.
    Parts(Parts),
}

/// Two disjoint sets of nodes `S` and `T`, with `|S| <= |T|`, such that all edges between them exist and attract, and all
/// edges inside either exist and repel. All edges together are paid `|S| |T| - |S|` or more: the 2-partition inequality of
/// Groetschel and Wakabayashi (1990).
///
/// Proof. Let a cluster contain `s` nodes of `S` and `t` of `T`. Of the edges between `S` and `T` it keeps `s t`, and inside
/// the sets it pays `s (s - 1) / 2 + t (t - 1) / 2`. As `(s - t) (s - t) >= |s - t|`, what it keeps minus what it pays is at
/// most `(s + t - |s - t|) / 2 = min(s, t)`. Over all clusters these minima add up to `|S|` at most.
///
/// Where `S` is one node, one attractive edge of it may go unpaid, however many there are; conflicted triangles alone add up
/// to half of the edges.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parts {
    pub(crate) few: Vec<u32>,
    pub(crate) many: Vec<u32>,
}

impl Parts {
    /// Every edge among and between the sets.
    fn edges(&self, kernel: &Kernel) -> Vec<u32> {
        let mut edges = Vec::new();
        for part in [&self.few, &self.many] {
            for (place, &tail) in part.iter().enumerate() {
                edges.extend(part[..place].iter().filter_map(|&head| kernel.edge(tail, head)));
            }
        }
        for &tail in &self.few {
            edges.extend(self.many.iter().filter_map(|&head| kernel.edge(tail, head)));
        }
        edges
    }
}

/// A closed walk with an odd number `k` of repulsive edges, and for each of these an attractive path to it from one centre.
/// All edges together, each as often as it occurs, are paid `(k + 1) / 2` or more. The walk may have attractive edges, and
/// spokes may be paths: contracting uncut edges turns this into the odd wheel inequality of Chopra and Rao (1993).
///
/// Proof. Let repulsive edge `i` lead from `v_i` to `w_i`. Let `q_i` be the payment of this edge and of the walk from `w_i`
/// on to `v_{i+1}`, and let `z_i` be 1 if the centre and `v_i` are apart, else 0. The spoke to `v_i` is paid at least `z_i`.
/// If `z_i` and `z_{i+1}` are both 0, then `q_i` is at least 1: either the centre's cluster contains `w_i` as well, and the
/// repulsive edge is paid, or the walk returns to the centre's cluster from outside. Let `s` of the `z_i` be 1. They are in
/// at most `2 s` of the `k` pairs `(z_i, z_{i+1})`, so at least `s + max(0, k - 2 s)` is paid. As `k` is odd, this is
/// `(k + 1) / 2` or more for each `s`.
///
/// Conflicted cycles alone, one for each `i`, add up to `k / 2`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wheel {
    /// Nodes of the walk; the last is followed by the first.
    pub(crate) rim: Vec<u32>,
    /// For each repulsive edge of the rim, in order, the nodes from the centre to the node where the walk enters the edge.
    pub(crate) spokes: Vec<Vec<u32>>,
}

impl Conflict {
    /// Each edge once, with the number of its uses.
    pub(crate) fn uses(&self, kernel: &Kernel) -> Vec<(u32, u32)> {
        match self {
            Self::Parts(parts) => parts.edges(kernel).into_iter().map(|edge| (edge, 1)).collect(),
            Self::Cycle(nodes) => kernel.cycle_edges(nodes).into_iter().map(|edge| (edge, 1)).collect(),
            Self::Wheel(wheel) => {
                let mut edges = kernel.cycle_edges(&wheel.rim);
                for spoke in &wheel.spokes {
                    edges.extend(spoke.windows(2).filter_map(|pair| kernel.edge(pair[0], pair[1])));
                }
                edges.sort_unstable();
                edges.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as u32)).collect()
            }
        }
    }

    /// One of its nodes.
    pub(crate) fn node(&self) -> Option<u32> {
        let nodes = match self {
            Self::Cycle(nodes) => nodes,
            Self::Parts(parts) => &parts.few,
            Self::Wheel(wheel) => &wheel.rim,
        };
        nodes.first().copied()
    }

    /// The same conflict in another kernel, where nodes were joined or left out: `None` if a node has no image, or if edges and signs
    /// there do not make a conflict of the images. Neighbours on a cycle may have one image. Wheels are not carried over: there
    /// are few, and they are found again.
    pub(crate) fn mapped(&self, kernel: &Kernel, image: impl Fn(u32) -> Option<u32>) -> Option<Self> {
        let images = |nodes: &[u32]| nodes.iter().map(|&node| image(node)).collect::<Option<Vec<u32>>>();
        let cost =
            |tail: u32, head: u32| kernel.edge(tail, head).map_or(0.0, |edge| kernel.costs[edge as usize]);
        match self {
            Self::Cycle(nodes) => {
                let mut nodes = images(nodes)?;
                nodes.dedup();
                let closes = cost(*nodes.first()?, *nodes.last()?) < 0.0;
                let attracts = nodes.windows(2).all(|pair| cost(pair[0], pair[1]) > 0.0);
                (closes && attracts && are_distinct(&nodes)).then_some(Self::Cycle(nodes))
            }
            Self::Parts(Parts { few, many }) => {
                let (few, many) = (images(few)?, images(many)?);
                // A pair of equal nodes has no edge, so that the images are distinct.
                let repels = |part: &[u32]| {
                    let mut pairs =
                        (1..part.len()).flat_map(|at| part[..at].iter().map(move |a| (*a, part[at])));
                    pairs.all(|(a, b)| cost(a, b) < 0.0)
                };
                let attracts = few.iter().all(|&a| many.iter().all(|&b| cost(a, b) > 0.0));
                (attracts && repels(&few) && repels(&many)).then_some(Self::Parts(Parts { few, many }))
            }
            Self::Wheel(_) => None,
        }
    }

    /// The least total payment of its edges.
    pub(crate) fn least(&self) -> f64 {
        match self {
            Self::Cycle(_) => 1.0,
            Self::Parts(parts) => (parts.few.len() * (parts.many.len() - 1)) as f64,
            Self::Wheel(wheel) => wheel.spokes.len().div_ceil(2) as f64,
        }
    }
}

fn are_distinct(nodes: &[u32]) -> bool {
    let mut sorted = nodes.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).all(|pair| pair[0] != pair[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::signed_graph::SignedGraph;

    /// Nodes 1 and 2 attract their neighbours in the circle 0, 1, 2, 3 and repel each other's; 0 and 3 repel.
    fn kernel() -> Kernel {
        let edges = [(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0), (0, 3, -1.0), (1, 3, -1.0), (0, 2, 1.0)];
        Kernel::new(&SignedGraph::new(4, edges.into_iter()))
    }

    fn cycle(nodes: &[u32]) -> Conflict {
        Conflict::Cycle(nodes.to_vec())
    }

    #[test]
    fn a_cycle_whose_neighbours_were_joined_gets_shorter() {
        let joined = |node: u32| Some([0, 1, 1, 2, 3][node as usize]);
        let mapped = cycle(&[0, 1, 2, 3, 4]).mapped(&kernel(), joined);
        assert_eq!(mapped, Some(cycle(&[0, 1, 2, 3])));
    }

    #[test]
    fn a_cycle_that_is_no_conflict_any_more_is_left_out() {
        let kernel = kernel();
        let by = |images: [u32; 4]| move |node: u32| Some(images[node as usize]);
        let conflict = cycle(&[0, 1, 2, 3]);
        // The last edge attracts, an inner edge repels, the ends are one node, a node occurs twice.
        for images in [[0, 1, 3, 2], [1, 3, 2, 0], [0, 1, 2, 0], [0, 1, 0, 3]] {
            assert_eq!(conflict.mapped(&kernel, by(images)), None, "{images:?}");
        }
        assert_eq!(conflict.mapped(&kernel, |node| (node > 0).then_some(node)), None);
    }

    #[test]
    fn parts_need_all_their_edges() {
        let parts =
            |few: &[u32], many: &[u32]| Conflict::Parts(Parts { few: few.to_vec(), many: many.to_vec() });
        let kernel = kernel();
        assert_eq!(
            parts(&[0], &[1, 2]).mapped(&kernel, |node| Some([2, 1, 3][node as usize])),
            Some(parts(&[2], &[1, 3]))
        );
        // Members of the larger set attract each other, or are one node.
        assert_eq!(parts(&[0], &[1, 2]).mapped(&kernel, Some), None);
        assert_eq!(parts(&[0], &[1, 2]).mapped(&kernel, |node| Some([2, 1, 1][node as usize])), None);
    }
}

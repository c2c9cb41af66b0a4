//! Conflicts that the kernels of a graph inherit from a program for the whole graph.

use crate::bound::conflict::Conflict;
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::reduce::decomposition::Decomposition;

/// The conflicts of a graph by kernels. A program that starts from them need not find them again, which takes most of the time
/// where a graph is dense.
pub(super) struct Inheritance<'a> {
    /// The kernel of each node, and its node there.
    images: Vec<Option<(u32, u32)>>,
    by_kernel: Vec<Vec<&'a Conflict>>,
}

impl<'a> Inheritance<'a> {
    pub(super) fn new(decomposition: &Decomposition, known: &'a [Conflict]) -> Self {
        let mut by_kernel = vec![Vec::new(); decomposition.kernels.len()];
        if known.is_empty() {
            return Self { images: Vec::new(), by_kernel };
        }
        let images = decomposition.images();
        for conflict in known {
            if let Some((kernel, _)) = conflict.node().and_then(|node| images[node as usize]) {
                by_kernel[kernel as usize].push(conflict);
            }
        }
        Self { images, by_kernel }
    }

    /// The conflicts that are still conflicts in one kernel.
    pub(super) fn of(&self, index: usize, graph: &SignedGraph) -> Vec<Conflict> {
        let inherited = &self.by_kernel[index];
        if inherited.is_empty() {
            return Vec::new();
        }
        let kernel = Kernel::new(graph);
        let image = |node: u32| match self.images[node as usize] {
            Some((place, image)) if place as usize == index => Some(image),
            _ => None,
        };
        inherited.iter().filter_map(|conflict| conflict.mapped(&kernel, image)).collect()
    }
}

//! The elimination tree and the structure of the factor's columns.
//!
//! J. W. H. Liu, "The role of elimination trees in sparse factorization", SIAM J. Matrix Anal. Appl. 11, 1990.

use crate::Adjacency;

/// No parent: a root of the elimination forest.
pub(crate) const ROOT: usize = usize::MAX;

/// Parents in the elimination tree of a pattern in elimination order; `lower` lists smaller neighbours. Liu's algorithm
/// with path compression, almost linear in the number of blocks.
pub(crate) fn elimination_tree(vertices: usize, lower: &Adjacency) -> Vec<usize> {
    let mut parent = vec![ROOT; vertices];
    let mut ancestor = vec![ROOT; vertices];
    for column in 0..vertices {
        for &row in lower.of(column) {
            // Walks from the row up to the root of its subtree so far, and makes this root a child of the column. All
            // vertices on the path then point to the column, so that later walks are short.
            let mut vertex = row;
            while vertex != ROOT && vertex < column {
                let next = ancestor[vertex];
                ancestor[vertex] = column;
                if next == ROOT {
                    parent[vertex] = column;
                }
                vertex = next;
            }
        }
    }
    parent
}

/// The children of each vertex of the forest, ascending.
pub(crate) fn children(parent: &[usize]) -> Adjacency {
    let edges = parent.iter().enumerate().filter(|&(_, &parent)| parent != ROOT);
    Adjacency::new(parent.len(), edges.map(|(child, &parent)| (parent, child)))
}

/// A postorder of the forest: children before parents, subtrees contiguous. `postorder[new] = old`.
pub(crate) fn postorder(parent: &[usize]) -> Vec<usize> {
    let vertices = parent.len();
    let children = children(parent);
    let mut order = Vec::with_capacity(vertices);
    let mut stack: Vec<(usize, usize)> = Vec::new();
    for root in (0..vertices).filter(|&vertex| parent[vertex] == ROOT) {
        stack.push((root, 0));
        while let Some((vertex, visited)) = stack.pop() {
            if let Some(&child) = children.of(vertex).get(visited) {
                stack.push((vertex, visited + 1));
                stack.push((child, 0));
            } else {
                order.push(vertex);
            }
        }
    }
    order
}

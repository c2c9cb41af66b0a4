//! Consistency graphs for other clique solvers.

use std::io::{self, Write};

use crate::clique::BitGraph;

/// The graph of one group, with the edge ids of its vertices.
#[derive(Clone, Debug)]
pub struct NamedGraph {
    /// The graph.
    pub graph: BitGraph,
    /// For each vertex the id of its landmark edge.
    pub edges: Vec<u64>,
}

/// Writes the groups as one graph in the DIMACS format of clique solvers: `p edge VERTICES EDGES`, then `e U V`. Vertices
/// count from 1, group after group; no edge joins two groups. Comments `c vertex V landmark ID` give the landmark edge of a
/// vertex, and `c group FIRST LAST` the vertices of a group.
pub fn write_dimacs(mut writer: impl Write, groups: &[NamedGraph]) -> io::Result<()> {
    let vertices: usize = groups.iter().map(|group| group.graph.len()).sum();
    let edges: usize = groups.iter().map(|group| group.graph.edges()).sum();
    let mut first = 1;
    for group in groups {
        writeln!(writer, "c group {first} {}", first + group.graph.len() - 1)?;
        for (vertex, id) in group.edges.iter().enumerate() {
            writeln!(writer, "c vertex {} landmark {id}", first + vertex)?;
        }
        first += group.graph.len();
    }
    writeln!(writer, "p edge {vertices} {edges}")?;
    let mut first = 1;
    for group in groups {
        for one in 0..group.graph.len() {
            for other in group.graph.neighbours_above(one) {
                writeln!(writer, "e {} {}", first + one, first + other)?;
            }
        }
        first += group.graph.len();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_follow_each_other() {
        let mut one = BitGraph::new(3);
        one.connect(0, 2);
        let mut other = BitGraph::new(2);
        other.connect(0, 1);
        let groups = [
            NamedGraph { graph: one, edges: vec![7, 8, 9] },
            NamedGraph { graph: other, edges: vec![10, 11] },
        ];
        let mut bytes = Vec::new();
        write_dimacs(&mut bytes, &groups).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains("c group 4 5\nc vertex 4 landmark 10\n"), "{text}");
        assert!(text.ends_with("p edge 5 2\ne 1 3\ne 4 5\n"), "{text}");
    }
}

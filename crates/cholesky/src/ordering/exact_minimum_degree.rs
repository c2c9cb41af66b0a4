//! Minimum degree on small graphs.

/// Order of elimination of the vertices below `inner` by minimum degree (G. R. Markowitz, 1957; W. F. Tinney and J. W. Walker, 1967); of
/// equal degrees, the lowest vertex comes first.
///
/// The other vertices up to `all` are eliminated later in any case, but they count in the degrees (halo approximate minimum degree: F.
/// Pellegrini, J. Roman, P. Amestoy, "Hybridizing nested dissection and halo approximate minimum degree", 2000). Sets of neighbours are
/// sets of bits: O(factor entries * all / 64 + inner^2).
pub(super) fn exact_minimum_degree(inner: usize, all: usize, pairs: &[(usize, usize)]) -> Vec<usize> {
    let words = all.div_ceil(64);
    let mut rows = vec![0_u64; inner * words];
    for &(a, b) in pairs {
        for (from, to) in [(a, b), (b, a)] {
            if from < inner {
                rows[from * words + to / 64] |= 1 << (to % 64);
            }
        }
    }
    let degree = |row: &[u64]| row.iter().map(|word| word.count_ones()).sum::<u32>();
    let mut degrees: Vec<u32> = (0..inner).map(|vertex| degree(&rows[vertex * words..][..words])).collect();
    let mut left: Vec<usize> = (0..inner).collect();
    let mut order = Vec::with_capacity(inner);
    let mut eliminated = vec![0; words];
    while let Some(place) = (0..left.len()).min_by_key(|&place| (degrees[left[place]], left[place])) {
        let vertex = left.swap_remove(place);
        order.push(vertex);
        eliminated.copy_from_slice(&rows[vertex * words..][..words]);
        // The neighbours become neighbours of each other.
        for neighbour in members(&eliminated).take_while(|&neighbour| neighbour < inner) {
            let row = &mut rows[neighbour * words..][..words];
            for (word, other) in row.iter_mut().zip(&eliminated) {
                *word |= other;
            }
            for gone in [vertex, neighbour] {
                row[gone / 64] &= !(1 << (gone % 64));
            }
            degrees[neighbour] = degree(row);
        }
    }
    order
}

/// The members of a set of bits in ascending order.
fn members(set: &[u64]) -> impl Iterator<Item = usize> {
    set.iter().enumerate().flat_map(|(word, &bits)| {
        let without_lowest = |&bits: &u64| Some(bits & (bits - 1)).filter(|&bits| bits != 0);
        let rest = std::iter::successors(Some(bits).filter(|&bits| bits != 0), without_lowest);
        rest.map(move |bits| 64 * word + bits.trailing_zeros() as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_go_before_the_vertex_that_joins_them() {
        assert_eq!(exact_minimum_degree(4, 4, &[(0, 1), (0, 2), (0, 3)]), [1, 2, 0, 3]);
        assert_eq!(exact_minimum_degree(0, 0, &[]), [0; 0]);
        // On a path of 200 vertices, no elimination adds an edge.
        let path: Vec<_> = (1..200).map(|vertex| (vertex - 1, vertex)).collect();
        assert_eq!(exact_minimum_degree(200, 200, &path), (0..200).collect::<Vec<_>>());
    }

    #[test]
    fn vertices_that_come_later_count_in_degrees() {
        // Vertex 0 has one neighbour inside and two outside, vertex 2 has one inside: the path goes from 2.
        assert_eq!(exact_minimum_degree(3, 5, &[(0, 1), (1, 2), (0, 3), (0, 4)]), [2, 1, 0]);
    }
}

//! Connected components of members.

use petgraph::unionfind::UnionFind;

/// Islands of linked members, in this order: the island on the mainland, then by falling size, then by first member.
pub(crate) struct Islands {
    islands: Vec<Vec<usize>>,
}

impl Islands {
    /// Takes, for each member (ascending), whether it is linked to the mainland and to which other members.
    pub(crate) fn of(members: &[usize], links: &[(bool, Vec<usize>)]) -> Self {
        let mainland = members.len();
        let mut parts = UnionFind::<usize>::new(members.len() + 1);
        for (place, (on_mainland, others)) in links.iter().enumerate() {
            if *on_mainland {
                parts.union(place, mainland);
            }
            for other in others {
                if let Ok(other) = members.binary_search(other) {
                    parts.union(place, other);
                }
            }
        }
        let labels = parts.into_labeling();
        let mut islands: Vec<Vec<usize>> = vec![Vec::new(); labels.len()];
        for (&member, &label) in members.iter().zip(&labels) {
            islands[label].push(member);
        }
        let first = std::mem::take(&mut islands[labels[mainland]]);
        islands.retain(|island| !island.is_empty());
        islands.sort_by_key(|island| std::cmp::Reverse(island.len()));
        if !first.is_empty() {
            islands.insert(0, first);
        }
        Self { islands }
    }

    /// Removes and returns the first island.
    pub(crate) fn take_first(&mut self) -> Vec<usize> {
        if self.islands.is_empty() { Vec::new() } else { self.islands.remove(0) }
    }

    /// Removes all islands for which a condition holds, and returns their members.
    pub(crate) fn take_where(&mut self, holds: impl Fn(&[usize]) -> bool) -> Vec<usize> {
        let (taken, left) = std::mem::take(&mut self.islands).into_iter().partition(|island| holds(island));
        self.islands = left;
        let taken: Vec<Vec<usize>> = taken;
        taken.concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mainland_comes_first_then_the_largest_island() {
        let members = [2, 3, 5, 7, 11, 13];
        let alone = || (false, Vec::new());
        let mut links =
            vec![(false, vec![3]), (false, vec![5]), alone(), (true, vec![]), (false, vec![13]), alone()];
        assert_eq!(Islands::of(&members, &links).islands, [vec![7], vec![2, 3, 5], vec![11, 13]]);
        links[3].0 = false;
        assert_eq!(Islands::of(&members, &links).islands, [vec![2, 3, 5], vec![11, 13], vec![7]]);
    }

    #[test]
    fn what_is_taken_is_gone() {
        let links = vec![(false, vec![2]), (false, vec![]), (false, vec![])];
        let mut islands = Islands::of(&[1, 2, 4], &links);
        assert_eq!(islands.take_first(), [1, 2]);
        assert_eq!(islands.take_where(|island| island == [4]), [4]);
        assert!(islands.take_first().is_empty());
    }
}

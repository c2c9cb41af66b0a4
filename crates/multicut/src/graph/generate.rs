//! Seeded graphs that resemble those of the pipeline: two sessions of viewpoints, correct landmark edges between near
//! viewpoints and false ones anywhere, with costs by support.

use posecut_random::rand::RngExt as _;
use posecut_random::rand::seq::SliceRandom as _;
use posecut_random::{ChaCha8Rng, random};

use crate::{Graph, GraphError};

/// Where the second session meets the first, and how false edges are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// The second session follows the first along its whole length: viewpoint i meets i - 2 ... i + 2.
    Follow,
    /// They meet on random segments of 20 to 60 viewpoints, over half of the length: viewpoint i meets i - 5 ... i + 5.
    Segments,
    /// Like `Segments`, but a third of the false edges lie in parallel bands of 3 to 8 edges that support each other.
    Aliased,
    /// One band along the whole length, i - 5 ... i + 5, with twice as many edges, so that hardly any edge lacks support.
    Dense,
}

impl Family {
    /// The family with the letter F, S, A or D.
    pub fn from_letter(letter: &str) -> Option<Self> {
        match letter {
            "F" => Some(Self::Follow),
            "S" => Some(Self::Segments),
            "A" => Some(Self::Aliased),
            "D" => Some(Self::Dense),
            _ => None,
        }
    }

    /// Largest distance between the ends of a correct edge, in viewpoints.
    fn reach(self) -> i64 {
        if self == Self::Follow { 2 } else { 5 }
    }
}

/// Draws a graph of two sessions with `viewpoints` nodes each, numbered one session after the other. It has about
/// `5 * viewpoints` edges (twice as many if dense), of which the share `incorrect` is false. An edge costs 1 if another edge
/// is within one viewpoint at both ends, and -1 otherwise: the paper's rule with delta 1.
///
/// `O(m log m)`; the same seed gives the same graph on every machine.
///
/// ```
/// use posecut_multicut::generate::{Family, generate};
/// let graph = generate(Family::Segments, 1000, 0.5, 1)?;
/// assert_eq!(graph.node_count(), 2000);
/// # Ok::<(), posecut_multicut::GraphError>(())
/// ```
pub fn generate(family: Family, viewpoints: u32, incorrect: f64, seed: u64) -> Result<Graph, GraphError> {
    let incorrect = incorrect.clamp(0.0, 1.0);
    let total = f64::from(viewpoints) * if family == Family::Dense { 10.0 } else { 5.0 };
    let mut pairs = correct(family, viewpoints, total * (1.0 - incorrect), seed);
    false_pairs(
        family,
        viewpoints,
        (total * incorrect) as usize,
        &mut random(seed, "false edges"),
        &mut pairs,
    );
    let mut sorted = pairs.clone();
    sorted.sort_unstable();
    sorted.dedup();
    let costs = costs(&sorted);
    // Shuffle, so that the order of a file does not follow the sessions.
    let mut edges: Vec<_> = sorted
        .iter()
        .zip(costs)
        .map(|(&(i, j), cost)| (u64::from(i), u64::from(viewpoints) + u64::from(j), cost))
        .collect();
    edges.shuffle(&mut random(seed, "order"));
    Graph::new(2 * viewpoints as usize, edges)
}

/// Pairs of near viewpoints, each kept with the probability at which `wanted` of them are expected.
fn correct(family: Family, viewpoints: u32, wanted: f64, seed: u64) -> Vec<(u32, u32)> {
    let length = i64::from(viewpoints);
    let mut place = random(seed, "segments");
    let mut near: Vec<(u32, u32)> = Vec::new();
    let mut meet = |start: i64, end: i64, offset: i64| {
        for i in start..end.min(length) {
            for j in i - family.reach()..=i + family.reach() {
                if (0..length).contains(&(j + offset)) && (start..end).contains(&j) {
                    near.push((i as u32, (j + offset) as u32));
                }
            }
        }
    };
    if matches!(family, Family::Follow | Family::Dense) {
        meet(0, length, 0);
    } else {
        let mut start = 0;
        while start < length {
            let end = (start + place.random_range(20..=60)).min(length);
            meet(start, end, place.random_range(0..=length - (end - start)) - start);
            start = end + place.random_range(20..=60);
        }
    }
    let keep = wanted / (near.len() as f64).max(1.0);
    let mut chance = random(seed, "correct edges");
    near.retain(|_| chance.random::<f64>() < keep);
    near
}

fn false_pairs(
    family: Family,
    viewpoints: u32,
    count: usize,
    random: &mut ChaCha8Rng,
    pairs: &mut Vec<(u32, u32)>,
) {
    let end = pairs.len() + count;
    let banded = if family == Family::Aliased { pairs.len() + count / 3 } else { 0 };
    while viewpoints > 0 && pairs.len() < end {
        let (i, j) = (random.random_range(0..viewpoints), random.random_range(0..viewpoints));
        let length = if pairs.len() < banded { random.random_range(3..=8) } else { 1 };
        pairs.extend((0..length).map(|k| (i + k, j + k)).filter(|&(i, j)| i < viewpoints && j < viewpoints));
    }
}

/// Costs of sorted pairs: 1 with a support edge, -1 without.
fn costs(sorted: &[(u32, u32)]) -> Vec<f64> {
    // In sorted order, a cursor runs along the pair's own row, then one along the next row; support is mutual.
    let mut supported = vec![false; sorted.len()];
    for step in [0, 1] {
        let mut first = 0;
        for (place, &(i, j)) in sorted.iter().enumerate() {
            let low = (i + step, j.saturating_sub(1));
            first = first.max(place * usize::from(step == 0));
            while first < sorted.len() && sorted[first] < low {
                first += 1;
            }
            for other in first..sorted.len() {
                if sorted[other] > (i + step, j + 1) {
                    break;
                }
                if other != place {
                    supported[place] = true;
                    supported[other] = true;
                }
            }
        }
    }
    supported.into_iter().map(|supported| if supported { 1.0 } else { -1.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_those_of_support() {
        for family in [Family::Follow, Family::Segments, Family::Aliased, Family::Dense] {
            let graph = generate(family, 300, 0.6, 3).unwrap();
            for edge in graph.edges() {
                let near = |other: &&crate::Edge| {
                    *other != edge
                        && other.tail.abs_diff(edge.tail) <= 1
                        && other.head.abs_diff(edge.head) <= 1
                };
                let expected = if graph.edges().iter().any(|other| near(&other)) { 1.0 } else { -1.0 };
                assert_eq!(edge.cost, expected, "{family:?} {edge:?}");
            }
        }
    }

    #[test]
    fn a_seed_fixes_the_graph_and_the_rate_its_mixture() {
        let draw = |seed| generate(Family::Follow, 2000, 0.5, seed).unwrap();
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        let repulsive = draw(1).edges().iter().filter(|edge| edge.cost < 0.0).count();
        let edges = draw(1).edges().len();
        assert!((9_700..=10_300).contains(&edges), "{edges}");
        assert!((4_500..=5_500).contains(&repulsive), "{repulsive}");
        assert_eq!(generate(Family::Aliased, 0, 0.5, 1).unwrap().node_count(), 0);
    }
}

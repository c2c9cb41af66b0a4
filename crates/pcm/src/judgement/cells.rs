//! Consistent sets for more candidates than a matrix of all pairs can hold.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::growth::grow_among;
use crate::Gate;
use crate::chance::Acceptance;
use crate::clique::{BitGraph, BitSet, Limits, MaximumClique, maximum_clique};
use crate::odometry::spread::Spatial;
use crate::pairs::consistency::{PairCounts, Pairs};

/// The most hypotheses of a cell.
const HYPOTHESES: usize = 3;
/// A cell with more candidates is split, because the cost of a cell is quadratic.
const LARGEST_CELL: usize = 512;
/// The most hypotheses in the search for the clique; their matrix takes 2 MB.
const MOST_HYPOTHESES: usize = 4096;

/// Rounds of growth. Candidates that joined in the first round are witnesses in the second, at positions without a
/// hypothesis. The second round tests only candidates that agreed with some member before.
const ROUNDS: usize = 2;

/// The result of the search by cells.
#[derive(Clone, Debug, Default)]
pub struct CellSolution {
    /// The centres of the hypotheses in the maximum clique that agree better than by chance, ascending.
    pub members: Vec<usize>,
    /// Candidates that agree with the members near them, ascending.
    pub grown: Vec<usize>,
    /// For each candidate: the number of others in its cell that it agrees with.
    pub degrees: Vec<usize>,
    /// The clique over the hypotheses.
    pub clique: MaximumClique,
    /// The number of cells that contain candidates.
    pub cells: usize,
    /// The number of hypotheses in the search for the clique.
    pub hypotheses: usize,
    /// The number of hypotheses left out, those of least support.
    pub hypotheses_left_out: usize,
    /// Candidates that agree with the kept ones, but no better than chance, ascending.
    pub by_chance: Vec<usize>,
    /// The false alarms of all these candidates. If a candidate appears more than once, its last entry counts.
    pub false_alarms: Vec<(usize, f64)>,
    /// The numbers of pairs by result.
    pub counts: PairCounts,
}

/// A candidate, and how many candidates agree with it, itself included.
struct Star {
    centre: usize,
    support: usize,
}

/// Sorts the candidates into cells of `size` metres travelled in either chain. In each cell, the candidate that agrees with
/// most others forms a hypothesis with them; a cell has up to three. The maximum clique over the hypotheses' centres gives
/// the members, without those that agree by chance alone according to `acceptance`. Then, in two rounds, every candidate
/// joins that agrees with three quarters of the eight members nearest to it, and better than by chance.
///
/// Memory: O(N). Time: O(N * candidates a cell + hypotheses^2), apart from the clique.
pub fn solve_by_cells<G: Spatial<DOF>, const DOF: usize>(
    pairs: &Pairs<'_, G, DOF>,
    gate: Gate,
    growth_gate: Gate,
    size: f64,
    limits: Limits,
    acceptance: Acceptance<DOF>,
) -> CellSolution {
    let cells = cells(pairs, gate, size);
    let mut solution =
        CellSolution { degrees: vec![0; pairs.len()], cells: cells.len(), ..CellSolution::default() };
    let found: Vec<(Vec<Star>, Vec<usize>, PairCounts)> =
        cells.par_iter().map(|cell| stars(pairs, cell, gate)).collect();
    let mut hypotheses = Vec::new();
    for (cell, (stars, degrees, counts)) in cells.iter().zip(found) {
        solution.counts += counts;
        hypotheses.extend(stars);
        for (&candidate, degree) in cell.iter().zip(degrees) {
            solution.degrees[candidate] = degree;
        }
    }
    hypotheses.sort_by_key(|star| (std::cmp::Reverse(star.support), star.centre));
    solution.hypotheses_left_out = hypotheses.len().saturating_sub(MOST_HYPOTHESES);
    hypotheses.truncate(MOST_HYPOTHESES);
    solution.hypotheses = hypotheses.len();
    let centres: Vec<usize> = hypotheses.iter().map(|star| star.centre).collect();
    let (graph, counts) = pairs.graph_of(&centres, gate);
    solution.counts += counts;
    solution.clique = maximum_clique(&graph, limits);
    solution.members = solution.clique.vertices.iter().map(|&vertex| centres[vertex]).collect();
    solution.members.sort_unstable();
    if gate.per_step.is_none() {
        let support = acceptance.chance(pairs).support(&solution.members, acceptance.cost);
        solution.members = support.supported;
        solution.by_chance = support.by_chance;
        solution.false_alarms = support.false_alarms;
    }
    let (mut kept, mut by_chance) = (solution.members.clone(), Vec::new());
    let mut asked: Vec<usize> = (0..pairs.len()).collect();
    for _ in 0..ROUNDS {
        let growth = grow_among(pairs, &kept, &asked, growth_gate, acceptance);
        asked = growth.open;
        solution.counts += growth.counts;
        solution.false_alarms.extend(growth.false_alarms);
        kept.extend(&growth.grown);
        solution.grown.extend(growth.grown);
        by_chance = growth.by_chance;
    }
    solution.grown.sort_unstable();
    solution.by_chance.extend(by_chance);
    solution.by_chance.retain(|candidate| solution.grown.binary_search(candidate).is_err());
    solution.by_chance.sort_unstable();
    solution.by_chance.dedup();
    solution
}

fn cells<G: Spatial<DOF>, const DOF: usize>(
    pairs: &Pairs<'_, G, DOF>,
    gate: Gate,
    size: f64,
) -> Vec<Vec<usize>> {
    let mut cells: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    for candidate in (0..pairs.len()).filter(|&candidate| pairs.agrees_with_odometry(candidate, gate)) {
        let cell = pairs.position(candidate).map(|metres| (metres / size).floor() as i64);
        cells.entry(cell).or_default().push(candidate);
    }
    cells
        .into_values()
        .flat_map(|mut cell| {
            if cell.len() > LARGEST_CELL {
                cell.sort_by(|&one, &other| {
                    let (one_at, other_at) = (pairs.position(one), pairs.position(other));
                    one_at[0].total_cmp(&other_at[0]).then(one.cmp(&other))
                });
            }
            cell.chunks(LARGEST_CELL).map(<[usize]>::to_vec).collect::<Vec<_>>()
        })
        .collect()
}

/// Up to three stars of a cell, and all degrees. The centre of a star has most neighbours among the remaining vertices.
fn stars<G: Spatial<DOF>, const DOF: usize>(
    pairs: &Pairs<'_, G, DOF>,
    cell: &[usize],
    gate: Gate,
) -> (Vec<Star>, Vec<usize>, PairCounts) {
    let mut counts = PairCounts::default();
    let mut graph = BitGraph::new(cell.len());
    for (row, &one) in cell.iter().enumerate() {
        for (column, &other) in cell.iter().enumerate().skip(row + 1) {
            if pairs.consistent(one, other, gate, &mut counts) {
                graph.connect(row, column);
            }
        }
    }
    let mut left = BitSet::full(cell.len());
    let mut stars = Vec::new();
    while stars.len() < HYPOTHESES {
        let degree = |vertex: usize| left.count_within(graph.neighbours(vertex));
        let Some(centre) = left.members().max_by_key(|&vertex| (degree(vertex), std::cmp::Reverse(vertex)))
        else {
            break;
        };
        stars.push(Star { centre: cell[centre], support: 1 + degree(centre) });
        left.remove(centre);
        left.subtract(graph.neighbours(centre));
    }
    let degrees = (0..cell.len()).map(|vertex| graph.degree(vertex)).collect();
    (stars, degrees, counts)
}

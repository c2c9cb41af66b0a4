//! From a relaxed solution to a clique.

use rand::Rng;
use rand::RngExt as _;

use crate::Affinity;
use crate::ascent::{ascend, dot, normalise};

/// The most power iterations for the value of a clique, and their relative tolerance.
const MOST_POWERS: usize = 1000;
const POWER_TOLERANCE: f64 = 1e-13;

/// A clique whose members agree well.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Densest {
    /// Its vertices, ascending: pairwise consistent, and no other vertex is consistent with all of them.
    pub vertices: Vec<usize>,
    /// How strongly each of them belongs: its component of the leading eigenvector of the clique's weights.
    pub shares: Vec<f64>,
    /// The largest eigenvalue of the clique's weights: its size if all weights are 1, less otherwise.
    pub density: f64,
    /// Gradient steps over all starts.
    pub steps: usize,
}

impl Densest {
    /// CLIPPER's selection: the round(density) vertices of the largest shares, which form the densest part of the clique.
    pub fn rounded(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.vertices.len()).collect();
        order.sort_by(|&a, &b| self.shares[b].total_cmp(&self.shares[a]));
        order.truncate(self.density.round() as usize);
        let mut chosen: Vec<usize> = order.into_iter().map(|place| self.vertices[place]).collect();
        chosen.sort_unstable();
        chosen
    }
}

/// The densest clique among several local maxima: one ascent starts from the vertices' degrees, `starts - 1` from random
/// vectors. The first found wins ties. This is a heuristic, because the problem is NP-hard (with weights 1 it is the
/// maximum clique).
///
/// A clique of n vertices has at most the density n. After the first ascent, the search considers only vertices that can be
/// in a clique as large as the density found. If these are exactly the clique found, it is the densest of all.
pub fn densest_clique(affinity: &Affinity, starts: usize, random: &mut impl Rng) -> Densest {
    let mut best = climb_once(affinity, &affinity.products(&vec![1.0; affinity.len()]).0, true);
    let mut core = affinity.core(best.density.ceil() as usize);
    let mut inside = None;
    for _ in 1..starts {
        if core == best.vertices {
            break;
        }
        let among = inside.get_or_insert_with(|| affinity.among(&core));
        let from: Vec<f64> = core.iter().map(|_| random.random_range(0.0..1.0)).collect();
        let found = climb_once(among, &from, false);
        let steps = best.steps + found.steps;
        if found.density > best.density {
            let vertices = found.vertices.iter().map(|&vertex| core[vertex]).collect();
            best = Densest { vertices, ..found };
            core = affinity.core(best.density.ceil() as usize);
            inside = None;
        }
        best.steps = steps;
    }
    best
}

/// The clique that one start leads to.
fn climb_once(affinity: &Affinity, from: &[f64], free: bool) -> Densest {
    let ascent = ascend(affinity, from, free);
    let vertices = maximal_clique(affinity, &ascent.solution);
    let (density, shares) = density(affinity, &vertices);
    Densest { vertices, shares, density, steps: ascent.steps }
}

/// Takes the vertices above zero, largest first, that are consistent with those taken before; then any vertices that are
/// consistent with all, heaviest first. The optimum is a maximal clique, because one more vertex raises the largest
/// eigenvalue of a matrix without negative entries (Perron and Frobenius).
fn maximal_clique(affinity: &Affinity, solution: &[f64]) -> Vec<usize> {
    let count = affinity.len();
    let mut order: Vec<usize> = (0..count).filter(|&vertex| solution[vertex] > 0.0).collect();
    order.sort_by(|&a, &b| solution[b].total_cmp(&solution[a]));
    // How many members each vertex is consistent with, and its weight with all of them.
    let (mut consistent, mut weight) = (vec![0_usize; count], vec![0.0_f64; count]);
    let mut clique: Vec<usize> = Vec::new();
    let mut order = order.into_iter();
    loop {
        let next = order.by_ref().find(|&vertex| consistent[vertex] == clique.len()).or_else(|| {
            // `max_by` returns the last of equals; in reverse order this is the first vertex.
            (0..count)
                .rev()
                .filter(|&vertex| consistent[vertex] == clique.len() && !clique.contains(&vertex))
                .max_by(|&a, &b| weight[a].total_cmp(&weight[b]))
        });
        let Some(next) = next else { break };
        clique.push(next);
        for &(other, pair) in affinity.neighbours(next) {
            consistent[other as usize] += 1;
            weight[other as usize] += f64::from(pair);
        }
    }
    clique.sort_unstable();
    clique
}

/// The largest eigenvalue of a clique's weights and its eigenvector, by power iteration. All entries are positive, so it
/// converges from any positive start.
fn density(affinity: &Affinity, clique: &[usize]) -> (f64, Vec<f64>) {
    let inside = affinity.among(clique);
    let mut shares = vec![1.0; clique.len()];
    normalise(&mut shares);
    let mut value = 0.0;
    for _ in 0..MOST_POWERS {
        let weigh = |&(other, weight): &(u32, f32)| f64::from(weight) * shares[other as usize];
        let mut next: Vec<f64> = (0..clique.len())
            .map(|vertex| shares[vertex] + inside.neighbours(vertex).iter().map(weigh).sum::<f64>())
            .collect();
        let next_value = dot(&shares, &next);
        normalise(&mut next);
        shares = next;
        let change = (next_value - value).abs();
        value = next_value;
        if change <= POWER_TOLERANCE * value {
            break;
        }
    }
    (value, shares)
}

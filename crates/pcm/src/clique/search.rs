//! Branch and bound with greedy colouring.

use rayon::prelude::*;

use super::bits::contains;
use super::degeneracy::Degeneracy;
use super::{BitGraph, BitSet, Limits};

/// Root branches searched at a time. All of them start from the largest clique known before the round, and the first of the
/// largest cliques that they find is taken. The result therefore does not depend on which branch finishes first.
const ROUND: usize = 16;

/// The number of class members that recolouring may examine, for each word of the candidates' rows. With hundreds of
/// colours, all pairs of classes would take a hundred times as long as the colouring itself. With this limit, a node costs
/// at most a few passes over these rows.
const CHECKS: usize = 4;

/// The result of a search in one graph.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    /// A largest clique, if one has more vertices than the search started from.
    pub(crate) clique: Option<Vec<usize>>,
    /// No clique has more vertices than this.
    pub(crate) upper_bound: usize,
    /// Nodes visited.
    pub(crate) work: u64,
}

/// Searches for a clique of more than `known` vertices (Tomita and Seki 2003; bit-parallel as San Segundo,
/// Rodriguez-Losada, Jimenez 2011; recolouring as Tomita et al. 2010).
pub(super) fn search(graph: &BitGraph, known: usize, limits: Limits) -> Outcome {
    // Vertices of high core number come first. Greedy colouring in this order needs few colours. Vertices of few
    // neighbours, whose subproblems are small, are coloured last and branched on first.
    let all = BitSet::full(graph.len());
    let mut order = Degeneracy::of(graph, &all).order;
    order.reverse();
    let renumbered = graph.induced(&order);
    let mut colours = Colours::new(renumbered.len());
    colours.colour(&renumbered, &all, known);
    let branches = std::mem::take(&mut colours.order);
    let mut best: Option<Vec<usize>> = None;
    let mut size = known;
    let mut work = 1;
    let mut upper_bound = known;
    let mut candidates = all;
    let mut left = &branches[..];
    while let Some(round) = next_round(&mut left, size) {
        // Equal shares, so that the work of a branch does not depend on other branches of the round, nor on threads.
        let share = limits.work.saturating_sub(work).div_ceil(round.len() as u64).min(limits.stall);
        let run = |place: usize, share: u64| {
            let mut own = candidates.clone();
            round[..=place].iter().for_each(|&(vertex, _)| own.remove(vertex));
            run_branch(&renumbered, round[place].0, &own, size, Limits { work: share, ..limits })
        };
        let mut outcomes: Vec<Found> =
            (0..round.len()).into_par_iter().map(|place| run(place, share)).collect();
        work += outcomes.iter().map(|found| found.work).sum::<u64>();
        for (place, found) in outcomes.iter_mut().enumerate() {
            // A branch that used up its share may use the work that the others did not need, unless it has stalled.
            let rest = limits.work.saturating_sub(work).min(limits.stall);
            if !found.complete && rest > share && !limits.is_over() {
                *found = run(place, rest);
                work += found.work;
            }
        }
        for &(vertex, _) in &round {
            candidates.remove(vertex);
        }
        for found in &outcomes {
            if found.clique.len() > size {
                size = found.clique.len();
                best = Some(found.clique.clone());
            }
        }
        // Branches come in order of falling numbers of colours: the number of the first unfinished one bounds it and all
        // after it.
        let open = round.iter().zip(&outcomes).find(|(_, found)| !found.complete);
        if let Some(((_, colours), _)) = open {
            upper_bound = *colours;
            break;
        }
    }
    let clique =
        best.map(|clique: Vec<usize>| clique.into_iter().map(|vertex| order[vertex]).collect::<Vec<_>>());
    Outcome { clique, upper_bound: upper_bound.max(size), work }
}

/// Takes the next branches, those of most colours first, if they can still lead to more than `size` vertices. A branch is a
/// vertex with its number of colours; its candidates are the neighbours that have not been branched on.
fn next_round(left: &mut &[(usize, usize)], size: usize) -> Option<Vec<(usize, usize)>> {
    let mut round = Vec::new();
    while round.len() < ROUND
        && let Some((&branch, rest)) = left.split_last()
        && branch.1 > size
    {
        *left = rest;
        round.push(branch);
    }
    (!round.is_empty()).then_some(round)
}

struct Found {
    clique: Vec<usize>,
    complete: bool,
    work: u64,
}

fn run_branch(graph: &BitGraph, vertex: usize, candidates: &BitSet, size: usize, limits: Limits) -> Found {
    let mut state = State {
        graph,
        limits,
        work: 0,
        complete: true,
        size,
        best: Vec::new(),
        clique: vec![vertex],
        colours: Colours::new(graph.len()),
    };
    let mut next = BitSet::new(graph.len());
    next.assign_intersection(candidates, graph.neighbours(vertex));
    state.expand(&next);
    Found { clique: state.best, complete: state.complete, work: state.work }
}

struct State<'a> {
    graph: &'a BitGraph,
    limits: Limits,
    work: u64,
    complete: bool,
    size: usize,
    best: Vec<usize>,
    clique: Vec<usize>,
    colours: Colours,
}

impl State<'_> {
    fn expand(&mut self, candidates: &BitSet) {
        if self.work >= self.limits.work || self.limits.is_over() {
            self.complete = false;
            return;
        }
        self.work += 1;
        if candidates.is_empty() {
            if self.clique.len() > self.size {
                self.size = self.clique.len();
                self.best.clone_from(&self.clique);
            }
            return;
        }
        self.colours.colour(self.graph, candidates, self.size.saturating_sub(self.clique.len()));
        let branches = std::mem::take(&mut self.colours.order);
        let mut candidates = candidates.clone();
        let mut next = BitSet::new(self.graph.len());
        // Vertices coloured last need the most colours, and cliques through them can be the largest.
        for &(vertex, colours) in branches.iter().rev() {
            // A clique has at most one vertex of each colour, and no later branch has more colours.
            if self.clique.len() + colours <= self.size {
                return;
            }
            next.assign_intersection(&candidates, self.graph.neighbours(vertex));
            self.clique.push(vertex);
            self.expand(&next);
            self.clique.pop();
            candidates.remove(vertex);
            if !self.complete {
                return;
            }
        }
    }
}

/// Greedy colouring: neighbours get different colours, so a clique has at most as many vertices as there are colours.
struct Colours {
    /// Vertices that need more than `spare` colours, each with the number of colours used up to it.
    order: Vec<(usize, usize)>,
    /// The members of each class. In dense graphs these are few, and a list is read faster than a row of bits.
    classes: Vec<Vec<usize>>,
    uncoloured: BitSet,
    class: BitSet,
    /// How many class members recolouring may still examine.
    budget: usize,
}

impl Colours {
    fn new(vertices: usize) -> Self {
        Self {
            order: Vec::new(),
            classes: Vec::new(),
            uncoloured: BitSet::new(vertices),
            class: BitSet::new(vertices),
            budget: 0,
        }
    }

    /// Colours the candidates. Those that get one of the first `spare` colours cannot lead to a larger clique and are not
    /// listed.
    fn colour(&mut self, graph: &BitGraph, candidates: &BitSet, spare: usize) {
        self.order = Vec::new();
        self.budget = CHECKS * candidates.count() * candidates.words().len();
        self.uncoloured.copy_from(candidates);
        let mut colours = 0;
        let mut first = 0;
        let words = self.uncoloured.words().len();
        while first < words {
            if self.uncoloured.words()[first] == 0 {
                first += 1;
                continue;
            }
            colours += 1;
            if self.classes.len() < colours {
                self.classes.push(Vec::new());
            }
            self.classes[colours - 1].clear();
            self.class.copy_from(&self.uncoloured);
            let listed = self.order.len();
            while let Some(vertex) = self.class.first_from(first) {
                self.class.remove(vertex);
                self.uncoloured.remove(vertex);
                self.class.subtract_from(first, graph.neighbours(vertex));
                self.classes[colours - 1].push(vertex);
                if colours > spare && !(spare > 0 && self.recolour(graph, vertex, colours, spare)) {
                    self.order.push((vertex, colours));
                }
            }
            // If recolouring has emptied the class, the next class takes its number, which keeps bounds tight.
            if colours > spare && self.order.len() == listed {
                colours -= 1;
            }
        }
    }

    /// Tries to move a vertex, the last of its class, into one of the first `spare` colours. This works if it has a single
    /// neighbour in a class there, and that neighbour fits into another of these classes.
    fn recolour(&mut self, graph: &BitGraph, vertex: usize, colours: usize, spare: usize) -> bool {
        for one in 0..spare {
            let class = &self.classes[one];
            if self.budget < class.len() {
                return false;
            }
            self.budget -= class.len();
            let row = graph.neighbours(vertex);
            let mut neighbours = (0..class.len()).filter(|&place| contains(row, class[place]));
            let Some(place) = neighbours.next() else { continue };
            if neighbours.next().is_some() {
                continue;
            }
            let neighbour = class[place];
            let row = graph.neighbours(neighbour);
            for other in (0..spare).filter(|&other| other != one) {
                let class = &self.classes[other];
                if self.budget < class.len() {
                    return false;
                }
                self.budget -= class.len();
                if !class.iter().any(|&member| contains(row, member)) {
                    self.classes[one][place] = vertex;
                    self.classes[other].push(neighbour);
                    self.classes[colours - 1].pop();
                    return true;
                }
            }
        }
        false
    }
}

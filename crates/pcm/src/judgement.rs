//! Judges the candidates of a group: pairs, maximum clique, growth and chance, one after the other.
//!
//! The clique needs a matrix of all pairs. For groups that are too large for one, [`cells`] uses hypotheses for each cell
//! of distance travelled. [`growth`] adds candidates that are missing from the clique because of a pair or two. Depends on
//! [`clique`](crate::clique), [`chance`](crate::chance), odometry and pairs.

pub mod cells;
pub mod figures;
pub mod growth;

use std::time::Instant;

use posecut_graph::PoseGraph;

use crate::chance::{Acceptance, Pool};
use crate::clique::{BitGraph, Limits, maximum_clique};
use crate::odometry::chain::Chains;
use crate::pairs::candidate::Group;
use crate::pairs::consistency::Pairs;
use crate::{Gate, Options, PcmError, STAGE, Scheme, Spatial};
use cells::solve_by_cells;
use figures::{Figures, Searched};
use growth::grow;

/// Whether a candidate is kept, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Clique,
    Grown,
    /// It agrees, but no better than chance.
    Chance,
    Outside,
}

impl Role {
    fn name(self) -> &'static str {
        match self {
            Self::Clique => "clique",
            Self::Grown => "grown",
            Self::Chance => "chance",
            Self::Outside => "outside",
        }
    }

    fn stays(self) -> bool {
        matches!(self, Self::Clique | Self::Grown)
    }
}

/// The result for the candidates of a group.
pub(crate) struct Judged {
    roles: Vec<Role>,
    degrees: Vec<usize>,
    /// For each candidate, if they were counted.
    false_alarms: Vec<Option<f64>>,
    /// The consistency graph, with the candidate of each vertex.
    pub(crate) graph: Option<(BitGraph, Vec<usize>)>,
    pub(crate) figures: Figures,
}

impl Judged {
    fn new(degrees: Vec<usize>) -> Self {
        let candidates = degrees.len();
        Self {
            roles: vec![Role::Outside; candidates],
            degrees,
            false_alarms: vec![None; candidates],
            graph: None,
            figures: Figures {
                candidates,
                lone_candidates: usize::from(candidates == 1),
                ..Figures::default()
            },
        }
    }

    fn play(&mut self, role: Role, candidates: &[usize]) {
        for &candidate in candidates {
            self.roles[candidate] = role;
        }
    }

    fn note(&mut self, false_alarms: &[(usize, f64)]) {
        for &(candidate, expected) in false_alarms {
            self.false_alarms[candidate] = Some(expected);
        }
    }

    /// Writes the evidence to the edges of the group, and rejects those that are not kept.
    pub(crate) fn mark<G, const DOF: usize>(&self, graph: &mut PoseGraph, group: &Group<G, DOF>) {
        for (place, candidate) in group.candidates.iter().enumerate() {
            let edge = &mut graph.edges[candidate.edge];
            edge.extra.insert("pcm_degree".to_owned(), self.degrees[place].into());
            edge.extra.insert("pcm_role".to_owned(), self.roles[place].name().into());
            if let Some(expected) = self.false_alarms[place] {
                edge.extra.insert("pcm_false_alarms".to_owned(), expected.into());
            }
            if !self.roles[place].stays() {
                edge.reject(STAGE);
            }
        }
    }

    /// Counts the roles.
    fn counted(mut self) -> Self {
        let playing = |role| self.roles.iter().filter(|&&played| played == role).count();
        self.figures.kept = self.roles.iter().filter(|role| role.stays()).count();
        self.figures.grown = playing(Role::Grown);
        self.figures.by_chance = playing(Role::Chance);
        self
    }
}

/// Judges the candidates of a group by the scheme for their number. `keep_graph` keeps the consistency graph.
pub(crate) fn judge<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    chains: &Chains<G, DOF>,
    group: &Group<G, DOF>,
    pool: Option<Pool<DOF>>,
    limits: Limits,
    keep_graph: bool,
) -> Result<Judged, PcmError> {
    let count = group.candidates.len();
    let scheme = options.scheme.for_candidates(count);
    if scheme == Scheme::Cells && keep_graph {
        return Err(PcmError::GraphNotMade { candidates: count, megabytes: (count * count / 8) >> 20 });
    }
    let pairs = Pairs::new(chains, group).with_odometry_test(!options.no_odometry_test);
    let acceptance = Acceptance::within(options.cost(), pool);
    let gate = options.gate(options.probability, count, DOF)?;
    let growth_gate = match options.grow {
        Some(probability) => Some(options.gate(probability, count, DOF)?),
        None => None,
    };
    let mut judged = match scheme {
        Scheme::Cells => by_cells(options, &pairs, (gate, growth_gate.unwrap_or(gate)), acceptance, limits),
        _ => by_clique(options, &pairs, (gate, growth_gate), acceptance, limits),
    };
    let graph = judged.graph.take().filter(|_| keep_graph);
    Ok(Judged { graph, ..judged.counted() })
}

fn by_cells<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    pairs: &Pairs<'_, G, DOF>,
    (gate, growth_gate): (Gate, Gate),
    acceptance: Acceptance<DOF>,
    limits: Limits,
) -> Judged {
    let start = Instant::now();
    let solution = solve_by_cells(pairs, gate, growth_gate, options.cell_size, limits, acceptance);
    let seconds_clique = start.elapsed().as_secs_f64();
    let mut judged = Judged::new(solution.degrees);
    judged.figures = Figures {
        seconds_clique,
        groups_by_cells: 1,
        cells: solution.cells,
        hypotheses: solution.hypotheses,
        hypotheses_left_out: solution.hypotheses_left_out,
        counts: solution.counts,
        clique_size: solution.members.len(),
        // Nothing is proved about candidates that are not hypotheses.
        clique_upper_bound: pairs.len(),
        searched: Searched::of(&solution.clique),
        work: solution.clique.work,
        ..judged.figures
    };
    judged.play(Role::Chance, &solution.by_chance);
    judged.play(Role::Grown, &solution.grown);
    judged.play(Role::Clique, &solution.members);
    judged.note(&solution.false_alarms);
    judged
}

fn by_clique<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    pairs: &Pairs<'_, G, DOF>,
    (gate, growth_gate): (Gate, Option<Gate>),
    acceptance: Acceptance<DOF>,
    limits: Limits,
) -> Judged {
    let start = Instant::now();
    let (tested, graph, counts) = pairs.tested_graph(gate);
    let seconds_pairs = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let clique = maximum_clique(&graph, limits);
    let seconds_clique = start.elapsed().as_secs_f64();
    let mut degrees = vec![0; pairs.len()];
    for (vertex, &candidate) in tested.iter().enumerate() {
        degrees[candidate] = graph.degree(vertex);
    }
    let mut judged = Judged::new(degrees);
    judged.figures = Figures {
        against_odometry: pairs.len() - tested.len(),
        counts,
        clique_size: clique.vertices.len(),
        clique_upper_bound: clique.upper_bound,
        searched: Searched::of(&clique),
        work: clique.work,
        seconds_pairs,
        seconds_clique,
        ..judged.figures
    };
    let mut members: Vec<usize> = clique.vertices.iter().map(|&vertex| tested[vertex]).collect();
    let start = Instant::now();
    if options.chance.is_some() {
        let support = acceptance.chance(pairs).support(&members, acceptance.cost);
        judged.play(Role::Chance, &support.by_chance);
        judged.note(&support.false_alarms);
        members = support.supported;
    }
    judged.play(Role::Clique, &members);
    if let Some(gate) = growth_gate {
        let growth = grow(pairs, &members, gate, acceptance);
        judged.play(Role::Chance, &growth.by_chance);
        judged.play(Role::Grown, &growth.grown);
        judged.note(&growth.false_alarms);
        judged.figures.counts += growth.counts;
    }
    judged.figures.seconds_growth = start.elapsed().as_secs_f64();
    judged.graph = Some((graph, tested));
    judged
}

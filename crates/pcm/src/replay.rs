//! The data that the stage decides on, for programs that display them: the consistency graphs without the decision.

use posecut_graph::{PoseGraph, for_dimension};

use crate::clique::BitGraph;
use crate::pairs::candidate::Group;
use crate::pairs::consistency::Pairs;
use crate::preparation::{candidates, scale};
use crate::{Gate, Options, PcmError, Spatial};

/// A group of candidates, and which of them agree.
#[derive(Clone, Debug)]
pub struct GroupConsistency {
    /// For each candidate: its index in the first chain, in the second chain, and among the graph's edges.
    pub places: Vec<(usize, usize, usize)>,
    /// The condition for a consistent pair.
    pub gate: Gate,
    /// The vertex of each candidate; none if the odometry alone rejects it.
    vertices: Vec<Option<usize>>,
    graph: BitGraph,
}

impl GroupConsistency {
    /// Whether two candidates are consistent.
    pub fn agree(&self, one: usize, other: usize) -> bool {
        matches!((self.vertices[one], self.vertices[other]), (Some(one), Some(other)) if self.graph.connected(one, other))
    }
}

/// The data that the stage decides on.
#[derive(Clone, Debug)]
pub struct Replay {
    /// The groups of candidates.
    pub groups: Vec<GroupConsistency>,
    /// The stage's warning, if there is one: [`Chains::warning`](crate::chain::Chains::warning).
    pub warning: Option<String>,
}

/// The consistency graphs of a graph before PCM, with the covariances, scales and gate of the options. The scheme of the
/// options is ignored. O(candidates^2) time, and as many bits.
pub fn consistency(options: &Options, graph: &PoseGraph) -> Result<Replay, PcmError> {
    options.check()?;
    for_dimension!(graph.header.dimension, |G, DOF| consistency_of::<G, DOF>(options, graph))
}

fn consistency_of<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &PoseGraph,
) -> Result<Replay, PcmError> {
    let (mut chains, mut grouped) = candidates::<G, DOF>(options, graph)?;
    scale(options, &mut chains, &mut grouped.groups);
    let of_group = |group: &Group<G, DOF>| {
        let gate = options.gate(options.probability, group.candidates.len(), DOF)?;
        let places =
            group.candidates.iter().map(|candidate| (candidate.i, candidate.k, candidate.edge)).collect();
        let pairs = Pairs::new(&chains, group).with_odometry_test(!options.no_odometry_test);
        let (tested, graph, _) = pairs.tested_graph(gate);
        let mut vertices = vec![None; group.candidates.len()];
        for (vertex, &candidate) in tested.iter().enumerate() {
            vertices[candidate] = Some(vertex);
        }
        Ok(GroupConsistency { places, gate, vertices, graph })
    };
    let groups = grouped.groups.iter().map(of_group).collect::<Result<_, PcmError>>()?;
    Ok(Replay { groups, warning: chains.warning() })
}

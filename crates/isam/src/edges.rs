//! The edges of the graph and their linearisations.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::collections::{BTreeMap, HashMap, HashSet};

use posecut_geometry::LieGroup;
use posecut_optimize::model::{Linearised, distance, size};
use posecut_optimize::{Edge, EdgeKind};

use crate::IncrementalError;
use crate::elimination::Incidence;
use crate::estimate::Estimate;
use crate::linear_model::LinearModel;
use crate::marginalise::AbsorbedEdge;

/// An edge as seen from one of its ends.
#[derive(Clone, Copy, Debug)]
struct Incident {
    slot: usize,
    other: usize,
    is_from: bool,
}

struct Slot<G, const DOF: usize> {
    id: u64,
    edge: Edge<G, DOF>,
    model: LinearModel<DOF>,
    /// Whether the edge waits in the list of edges to linearise.
    outdated: bool,
    share: Share,
    /// The last check that looked at this edge.
    checked: usize,
}

/// What an edge adds to the sums, as of its last linearisation or check.
#[derive(Clone, Copy, Debug, Default)]
struct Share {
    /// The squared error of the linear model.
    error: f64,
    cost: f64,
    /// The cost of a residual as long as the measured distance along each axis, and of one radian about each axis.
    size: f64,
}

impl Share {
    /// Replaces a summand.
    fn exchange(&mut self, old: &mut Self, new: Self) {
        self.error += new.error - old.error;
        self.cost += new.cost - old.cost;
        self.size += new.size - old.size;
        *old = new;
    }
}

/// Edges in slots that are reused, listed at both ends.
pub(crate) struct Edges<G, const DOF: usize> {
    slots: Vec<Slot<G, DOF>>,
    free: Vec<usize>,
    by_id: HashMap<u64, usize>,
    next_id: u64,
    /// The ends of the edges that priors have absorbed, by number: what an error about them says.
    absorbed: HashMap<u64, [usize; 2]>,
    at: Vec<Vec<Incident>>,
    outdated: Vec<usize>,
    sums: Share,
    checks: usize,
}

impl<G, const DOF: usize> std::fmt::Debug for Edges<G, DOF> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Edges").field("count", &self.by_id.len()).finish_non_exhaustive()
    }
}

impl<G: LieGroup<DOF>, const DOF: usize> Edges<G, DOF> {
    pub(crate) fn new() -> Self {
        Self {
            slots: Vec::new(),
            free: Vec::new(),
            by_id: HashMap::new(),
            next_id: 0,
            absorbed: HashMap::new(),
            at: Vec::new(),
            outdated: Vec::new(),
            sums: Share::default(),
            checks: 0,
        }
    }

    pub(crate) fn add_node(&mut self) {
        self.at.push(Vec::new());
    }

    /// The number that the next edge will have.
    pub(crate) fn next_id(&self) -> u64 {
        self.next_id
    }

    pub(crate) fn add(&mut self, edge: Edge<G, DOF>) -> u64 {
        let id = self.next_id;
        self.next_id += 1;
        let slot = Slot {
            id,
            edge,
            model: LinearModel::none(),
            outdated: true,
            share: Share::default(),
            checked: 0,
        };
        let index = if let Some(index) = self.free.pop() {
            self.slots[index] = slot;
            index
        } else {
            self.slots.push(slot);
            self.slots.len() - 1
        };
        self.by_id.insert(id, index);
        self.at[edge.from].push(Incident { slot: index, other: edge.to, is_from: true });
        self.at[edge.to].push(Incident { slot: index, other: edge.from, is_from: false });
        self.outdated.push(index);
        id
    }

    pub(crate) fn remove(&mut self, id: u64) -> Result<Edge<G, DOF>, IncrementalError> {
        let Some(index) = self.by_id.remove(&id) else {
            return Err(if let Some(&[from, to]) = self.absorbed.get(&id) {
                IncrementalError::AbsorbedEdge { edge: id, from, to }
            } else if id < self.next_id {
                IncrementalError::RemovedEdge { edge: id }
            } else {
                IncrementalError::UnknownEdge { edge: id }
            });
        };
        let edge = self.slots[index].edge;
        for node in [edge.from, edge.to] {
            self.at[node].retain(|incident| incident.slot != index);
        }
        self.release(index);
        Ok(edge)
    }

    fn release(&mut self, index: usize) {
        self.slots[index].outdated = false;
        self.sums.exchange(&mut self.slots[index].share, Share::default());
        self.free.push(index);
    }

    /// Takes out all edges at these nodes, with their models, in the order of their numbers. They can no longer be removed.
    pub(crate) fn absorb(&mut self, nodes: &[usize]) -> Vec<AbsorbedEdge<G, DOF>> {
        let incidents = nodes.iter().flat_map(|&node| &self.at[node]);
        let taken: BTreeMap<u64, usize> =
            incidents.map(|incident| (self.slots[incident.slot].id, incident.slot)).collect();
        let slots: HashSet<usize> = taken.values().copied().collect();
        let mut edges = Vec::with_capacity(taken.len());
        for (id, index) in taken {
            self.by_id.remove(&id);
            let slot = &mut self.slots[index];
            let edge = slot.edge;
            let model = std::mem::replace(&mut slot.model, LinearModel::none()).blocks;
            self.release(index);
            for node in [edge.from, edge.to] {
                self.at[node].retain(|incident| !slots.contains(&incident.slot));
            }
            self.absorbed.insert(id, [edge.from, edge.to]);
            edges.push((edge, model));
        }
        for &node in nodes {
            self.at[node] = Vec::new();
        }
        edges
    }

    /// Number of edges that priors have absorbed.
    pub(crate) fn absorbed(&self) -> usize {
        self.absorbed.len()
    }

    /// Number of current edges.
    pub(crate) fn count(&self) -> usize {
        self.by_id.len()
    }

    /// Whether a node has a landmark edge.
    pub(crate) fn has_landmark(&self, node: usize) -> bool {
        self.at[node].iter().any(|incident| self.slots[incident.slot].edge.kind == EdgeKind::Landmark)
    }

    /// The other ends of the edges at a node.
    pub(crate) fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        self.at[node].iter().map(|incident| incident.other)
    }

    /// The current edges with their numbers, ascending.
    pub(crate) fn list(&self) -> impl Iterator<Item = (u64, &Edge<G, DOF>)> {
        let mut live: Vec<_> = self.by_id.iter().map(|(&id, &slot)| (id, slot)).collect();
        live.sort_unstable();
        live.into_iter().map(|(id, slot)| (id, &self.slots[slot].edge))
    }

    /// Marks the edges at a node for linearisation.
    pub(crate) fn outdate(&mut self, node: usize) {
        for incident in &self.at[node] {
            if !std::mem::replace(&mut self.slots[incident.slot].outdated, true) {
                self.outdated.push(incident.slot);
            }
        }
    }

    /// Linearises the outdated edges and returns their number.
    pub(crate) fn linearise(&mut self, points: &[G]) -> usize {
        let mut count = 0;
        for index in self.outdated.drain(..) {
            let slot = &mut self.slots[index];
            if std::mem::replace(&mut slot.outdated, false) {
                slot.model = LinearModel::new(&slot.edge, points);
                let size = size(&slot.edge, distance(&slot.edge.measurement));
                self.sums.exchange(&mut slot.share, Share { error: 0.0, cost: slot.model.blocks.cost, size });
                count += 1;
            }
        }
        count
    }

    /// Begins a check of the linear models' errors.
    pub(crate) fn begin_check(&mut self) {
        self.checks += 1;
        // One infinite or NaN summand would stay in the running sums for good: compute them anew.
        if !(self.sums.error + self.sums.cost + self.sums.size).is_finite() {
            self.sums = Share::default();
            for &slot in self.by_id.values() {
                let Share { error, cost, size } = self.slots[slot].share;
                self.sums.error += error;
                self.sums.cost += cost;
                self.sums.size += size;
            }
        }
    }

    /// Computes the errors of a node's edges anew, each edge once per check.
    pub(crate) fn check(&mut self, node: usize, estimate: &Estimate<G, DOF>) {
        let here = estimate.pose(node);
        for incident in &self.at[node] {
            let slot = &mut self.slots[incident.slot];
            if slot.outdated || std::mem::replace(&mut slot.checked, self.checks) == self.checks {
                continue;
            }
            let there = estimate.pose(incident.other);
            let poses = if incident.is_from { [&here, &there] } else { [&there, &here] };
            let deltas = [slot.edge.from, slot.edge.to].map(|node| &estimate.deltas[node]);
            let (error, cost) = slot.model.error(&slot.edge, poses, deltas);
            let size = slot.share.size;
            self.sums.exchange(&mut slot.share, Share { error, cost, size });
        }
    }

    /// The sums of squared model errors and of costs, each edge as of its last linearisation or check. The cost is at least
    /// `least` times the sum of `size`.
    pub(crate) fn error_and_cost(&self, least: f64) -> (f64, f64) {
        (self.sums.error, self.sums.cost.max(least * self.sums.size))
    }

    /// Memory used, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let incidents: usize = self.at.iter().map(Vec::capacity).sum();
        self.slots.capacity() * size_of::<Slot<G, DOF>>()
            + incidents * size_of::<Incident>()
            + (self.free.capacity() + self.outdated.capacity()) * size_of::<usize>()
            + self.by_id.capacity() * size_of::<(u64, usize)>()
            + self.absorbed.capacity() * size_of::<(u64, [usize; 2])>()
    }
}

impl<G, const DOF: usize> Incidence<DOF> for Edges<G, DOF> {
    #[inline(always)]
    fn for_each(&self, node: usize, mut each: impl FnMut(usize, &Linearised<DOF>, bool)) {
        for incident in &self.at[node] {
            each(incident.other, &self.slots[incident.slot].model.blocks, incident.is_from);
        }
    }
}

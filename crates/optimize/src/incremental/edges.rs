//! Edges that come and go, with their linearisations.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::collections::HashMap;

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;

use super::IncrementalError;
use super::elimination::Incidence;
use crate::problem::Edge;
use crate::residual::{Linearised, linearise};

/// An edge as seen from one of its ends.
#[derive(Clone, Copy, Debug)]
struct Incident {
    slot: usize,
    other: usize,
    is_from: bool,
}

struct Slot<G, const DOF: usize> {
    edge: Edge<G, DOF>,
    model: Linearised<DOF>,
    /// Whether the model is waiting in the list of those to be made.
    outdated: bool,
}

/// Edges in slots that are used again, listed at both ends.
pub(super) struct Edges<G, const DOF: usize> {
    slots: Vec<Slot<G, DOF>>,
    free: Vec<usize>,
    by_id: HashMap<u64, usize>,
    next_id: u64,
    at: Vec<Vec<Incident>>,
    outdated: Vec<usize>,
}

impl<G, const DOF: usize> std::fmt::Debug for Edges<G, DOF> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Edges").field("count", &self.by_id.len()).finish_non_exhaustive()
    }
}

impl<G: LieGroup<DOF>, const DOF: usize> Edges<G, DOF> {
    pub(super) fn new() -> Self {
        Self {
            slots: Vec::new(),
            free: Vec::new(),
            by_id: HashMap::new(),
            next_id: 0,
            at: Vec::new(),
            outdated: Vec::new(),
        }
    }

    pub(super) fn add_node(&mut self) {
        self.at.push(Vec::new());
    }

    /// The number that the next edge will have.
    pub(super) fn next_id(&self) -> u64 {
        self.next_id
    }

    pub(super) fn add(&mut self, edge: Edge<G, DOF>) -> u64 {
        let id = self.next_id;
        self.next_id += 1;
        let slot = Slot { edge, model: no_model(), outdated: true };
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

    pub(super) fn remove(&mut self, id: u64) -> Result<Edge<G, DOF>, IncrementalError> {
        let Some(index) = self.by_id.remove(&id) else {
            return Err(if id < self.next_id {
                IncrementalError::RemovedEdge { edge: id }
            } else {
                IncrementalError::UnknownEdge { edge: id }
            });
        };
        let edge = self.slots[index].edge;
        for node in [edge.from, edge.to] {
            self.at[node].retain(|incident| incident.slot != index);
        }
        self.slots[index].outdated = false;
        self.free.push(index);
        Ok(edge)
    }

    /// The other ends of the edges at a node.
    pub(super) fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        self.at[node].iter().map(|incident| incident.other)
    }

    /// The edges that are there with their numbers, ascending.
    pub(super) fn list(&self) -> impl Iterator<Item = (u64, &Edge<G, DOF>)> {
        let mut live: Vec<_> = self.by_id.iter().map(|(&id, &slot)| (id, slot)).collect();
        live.sort_unstable();
        live.into_iter().map(|(id, slot)| (id, &self.slots[slot].edge))
    }

    /// Has the edges at a node linearised again.
    pub(super) fn outdate(&mut self, node: usize) {
        for incident in &self.at[node] {
            if !std::mem::replace(&mut self.slots[incident.slot].outdated, true) {
                self.outdated.push(incident.slot);
            }
        }
    }

    /// Linearises what is outdated and returns the number of edges.
    pub(super) fn linearise(&mut self, points: &[G]) -> usize {
        let mut count = 0;
        for index in self.outdated.drain(..) {
            let slot = &mut self.slots[index];
            if std::mem::replace(&mut slot.outdated, false) {
                slot.model = linearise(&slot.edge, points);
                count += 1;
            }
        }
        count
    }

    /// Memory held, bytes.
    pub(super) fn bytes(&self) -> usize {
        let incidents: usize = self.at.iter().map(Vec::capacity).sum();
        self.slots.capacity() * size_of::<Slot<G, DOF>>()
            + incidents * size_of::<Incident>()
            + (self.free.capacity() + self.outdated.capacity()) * size_of::<usize>()
            + self.by_id.capacity() * size_of::<(u64, usize)>()
    }
}

impl<G, const DOF: usize> Incidence<DOF> for Edges<G, DOF> {
    #[inline(always)]
    fn for_each(&self, node: usize, mut each: impl FnMut(usize, &Linearised<DOF>, bool)) {
        for incident in &self.at[node] {
            each(incident.other, &self.slots[incident.slot].model, incident.is_from);
        }
    }
}

/// What stands in a slot until its edge is linearised.
fn no_model<const DOF: usize>() -> Linearised<DOF> {
    Linearised {
        from_from: SMatrix::zeros(),
        from_to: SMatrix::zeros(),
        to_to: SMatrix::zeros(),
        from_gradient: SVector::zeros(),
        to_gradient: SVector::zeros(),
        cost: 0.0,
    }
}

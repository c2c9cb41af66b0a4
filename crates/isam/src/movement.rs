//! How far poses have moved since their edges were linearised and last checked.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::SVector;
use posecut_geometry::{LieGroup, translations};

use crate::IncrementalOptions;
use crate::edges::Edges;
use crate::estimate::Estimate;

/// A Gauss-Newton step with a larger rotation than this, in radians, is trusted only if it lowers the cost. The same holds
/// for a translation longer than all measured distances together.
const LONG_ROTATION: f64 = 0.5;

/// The movements that decide about relinearisation.
#[derive(Debug)]
pub(crate) struct Movement<const DOF: usize> {
    /// Thresholds by component: metres, then radians.
    thresholds: [f64; DOF],
    /// Linear updates at the last check of a node's edges.
    checked: Vec<SVector<f64, DOF>>,
    /// Nodes whose linear update has changed by more than a threshold since that check.
    moved: Vec<usize>,
    /// Nodes whose linear update may exceed a threshold.
    candidates: Vec<usize>,
    /// Whether the last solution moved a pose too far to be trusted.
    pub(crate) long_step: bool,
    /// The sum of all measured distances, including those of removed edges.
    pub(crate) reach: f64,
}

impl<const DOF: usize> Movement<DOF> {
    pub(crate) fn new(options: &IncrementalOptions) -> Self {
        Self {
            thresholds: std::array::from_fn(|component| options.relinearise(component, DOF)),
            checked: Vec::new(),
            moved: Vec::new(),
            candidates: Vec::new(),
            long_step: false,
            reach: 0.0,
        }
    }

    pub(crate) fn add_node(&mut self) {
        self.checked.push(SVector::zeros());
    }

    /// Notes that a pose was relinearised: its linear update is zero.
    pub(crate) fn reset(&mut self, node: usize) {
        self.checked[node] = SVector::zeros();
    }

    /// Forgets which poses have moved, since everything is linearised again.
    pub(crate) fn clear(&mut self) {
        self.moved.clear();
        self.candidates.clear();
    }

    /// Whether a component exceeds its threshold.
    #[inline(always)]
    pub(crate) fn is_beyond(&self, value: &SVector<f64, DOF>) -> bool {
        // Written so that NaN exceeds every threshold.
        value.iter().zip(&self.thresholds).any(|(value, threshold)| !(value.abs() <= *threshold))
    }

    /// Notes whether a new linear update has moved far since the last check of the node's edges, and whether the step is
    /// long.
    #[inline(always)]
    pub(crate) fn note(&mut self, node: usize, value: &SVector<f64, DOF>) {
        if self.is_beyond(&(value - self.checked[node])) {
            self.moved.push(node);
            let (along, about) = value.as_slice().split_at(translations(DOF));
            self.long_step |= about.iter().any(|angle| !(angle.abs() <= LONG_ROTATION))
                || along.iter().any(|length| !(length.abs() <= self.reach));
        }
    }

    /// Checks the edges of variables that have moved.
    pub(crate) fn look<G: LieGroup<DOF>>(
        &mut self,
        fixed: &[bool],
        estimate: &Estimate<G, DOF>,
        edges: &mut Edges<G, DOF>,
    ) {
        edges.begin_check();
        for node in std::mem::take(&mut self.moved) {
            if !fixed[node] && self.is_beyond(&(estimate.deltas[node] - self.checked[node])) {
                if self.checked[node].amax() == 0.0 {
                    self.candidates.push(node);
                }
                self.checked[node] = estimate.deltas[node];
                edges.check(node, estimate);
            }
        }
    }

    /// Takes the nodes whose linear update may exceed a threshold, and empties their list.
    pub(crate) fn take_candidates(&mut self) -> Vec<usize> {
        std::mem::take(&mut self.candidates)
    }

    /// Memory used, bytes.
    pub(crate) fn bytes(&self) -> usize {
        (self.moved.capacity() + self.candidates.capacity()) * size_of::<usize>()
    }
}

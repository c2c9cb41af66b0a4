//! Nodes that stay where they are.

use posecut_graph::connectivity::Component;

/// Puts the nodes of a part that are held first and returns how many there are. Where none is, the first node alone is held: it
/// only fixes the gauge.
pub(crate) fn put_held_first(component: &mut Component, held: &[bool]) -> usize {
    component.nodes.sort_by_key(|&node| !held[node]);
    count_held(component, held).max(1)
}

/// How many nodes of a part are held.
pub(crate) fn count_held(component: &Component, held: &[bool]) -> usize {
    component.nodes.iter().filter(|&&node| held[node]).count()
}

//! Nodes whose poses are constants.

use posecut_graph::connectivity::Component;

/// Moves a component's held nodes to the front and returns how many there are. If none is held, this holds the first node
/// alone, which only fixes the gauge.
pub(crate) fn put_held_first(component: &mut Component, held: &[bool]) -> usize {
    component.nodes.sort_by_key(|&node| !held[node]);
    count_held(component, held).max(1)
}

/// Number of held nodes of a component.
pub(crate) fn count_held(component: &Component, held: &[bool]) -> usize {
    component.nodes.iter().filter(|&&node| held[node]).count()
}

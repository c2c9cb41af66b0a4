//! Nodes whose poses are constants.

use posecut_graph::connectivity::Component;

/// Moves a component's held nodes to the front and returns how many there are. If none is held and no prior applies to the
/// component, this holds the first node alone, which only fixes the gauge. Priors fix the gauge themselves: with them a held
/// node would be one more measurement.
pub(crate) fn put_held_first(component: &mut Component, held: &[bool], anchored: bool) -> usize {
    component.nodes.sort_by_key(|&node| !held[node]);
    count_held(component, held).max(usize::from(!anchored))
}

/// Number of held nodes of a component.
pub(crate) fn count_held(component: &Component, held: &[bool]) -> usize {
    component.nodes.iter().filter(|&&node| held[node]).count()
}

//! Whom each candidate is compared with.

use posecut_pcm::consistency::Pairs;
use posecut_pcm::nearest::Nearest;

use crate::ingredients::Ingredient;
use crate::model::{Model, Motion};

/// Nearest partners, and partners anywhere.
pub(crate) const NEAR: usize = 8;
const FAR: usize = 8;

/// Near and far partners of every closure, within its group.
pub(crate) struct Partners {
    near: Vec<Vec<usize>>,
    far: Vec<Vec<usize>>,
}

impl Partners {
    pub(crate) fn of<G: Motion<DOF>, const DOF: usize>(model: &Model<G, DOF>) -> Self {
        let far_ones = if model.without(Ingredient::FarPartners) { 0 } else { FAR };
        let (mut near, mut far) = (Vec::new(), Vec::new());
        for (group, span) in model.groups.iter().zip(&model.spans) {
            let pairs = Pairs::new(&model.chains, group);
            let all: Vec<usize> = (0..group.candidates.len()).collect();
            let nearest = Nearest::new(&pairs, &all);
            for candidate in 0..all.len() {
                let found = nearest.of(pairs.position(candidate), candidate, NEAR);
                let others = (1..=far_ones).map(|turn| elsewhere(candidate, turn, all.len()));
                let mut others: Vec<usize> =
                    others.filter(|other| *other != candidate && !found.contains(other)).collect();
                others.sort_unstable();
                others.dedup();
                near.push(found.iter().map(|other| span.first + other).collect());
                far.push(others.iter().map(|other| span.first + other).collect());
            }
        }
        Self { near, far }
    }

    pub(crate) fn near(&self, closure: usize) -> &[usize] {
        &self.near[closure]
    }

    pub(crate) fn far(&self, closure: usize) -> &[usize] {
        &self.far[closure]
    }

    /// Another closure of the same group, mostly far away.
    pub(crate) fn elsewhere<G: Motion<DOF>, const DOF: usize>(
        model: &Model<G, DOF>,
        closure: usize,
        turn: usize,
    ) -> usize {
        let span = model.span(closure);
        span.first + elsewhere(closure - span.first, turn, span.end - span.first)
    }
}

/// Steps of the golden section spread over all places without a pattern.
fn elsewhere(one: usize, turn: usize, count: usize) -> usize {
    let step = 1.0 + (count as f64 - 1.0) * (0.618_034 * turn as f64).fract();
    (one + step as usize) % count
}

//! The partners with which each candidate is compared.

use posecut_pcm::consistency::Pairs;
use posecut_pcm::nearest::Nearest;
use rayon::prelude::*;

use crate::ingredients::Ingredient;
use crate::model::{Model, Motion};

/// Numbers of nearest partners, and of partners anywhere.
pub(crate) const NEAR: usize = 8;
const FAR: usize = 8;
/// Ranks by distance of partners in between. If two groups are interleaved, the nearest partners of each member are all in
/// its own group, and far away the odometry is too uncertain to distinguish the groups.
const MIDDLE: [usize; 3] = [16, 32, 64];

/// Partners of every closure, within its group.
pub(crate) struct Partners {
    near: Vec<Vec<usize>>,
    middle: Vec<Vec<usize>>,
    far: Vec<Vec<usize>>,
}

impl Partners {
    pub(crate) fn of<G: Motion<DOF>, const DOF: usize>(model: &Model<G, DOF>) -> Self {
        let (far_ones, ranks): (usize, &[usize]) =
            if model.without(Ingredient::FarPartners) { (0, &[]) } else { (FAR, &MIDDLE) };
        let most = ranks.last().map_or(NEAR, |rank| NEAR.max(*rank));
        let (mut near, mut middle, mut far) = (Vec::new(), Vec::new(), Vec::new());
        for (group, span) in model.groups.iter().zip(&model.spans) {
            let pairs = Pairs::new(&model.chains, group);
            let all: Vec<usize> = (0..group.candidates.len()).collect();
            let nearest = Nearest::new(&pairs, &all);
            let partners = all.par_iter().map(|&candidate| {
                let found = nearest.of(pairs.position(candidate), candidate, most);
                let between = ranks.iter().filter_map(|rank| found.get(rank - 1));
                let middle: Vec<usize> = between.map(|other| span.first + other).collect();
                let found = &found[..NEAR.min(found.len())];
                let others = (1..=far_ones).map(|turn| elsewhere(candidate, turn, all.len()));
                let mut others: Vec<usize> =
                    others.filter(|other| *other != candidate && !found.contains(other)).collect();
                others.sort_unstable();
                others.dedup();
                let near: Vec<usize> = found.iter().map(|other| span.first + other).collect();
                (near, middle, others.iter().map(|other| span.first + other).collect::<Vec<_>>())
            });
            for (of_near, of_middle, of_far) in partners.collect::<Vec<_>>() {
                near.push(of_near);
                middle.push(of_middle);
                far.push(of_far);
            }
        }
        Self { near, middle, far }
    }

    pub(crate) fn near(&self, closure: usize) -> &[usize] {
        &self.near[closure]
    }

    pub(crate) fn far(&self, closure: usize) -> &[usize] {
        &self.far[closure]
    }

    /// All partners of a closure.
    pub(crate) fn all(&self, closure: usize) -> impl Iterator<Item = usize> {
        [&self.near, &self.middle, &self.far].into_iter().flat_map(move |of| of[closure].iter().copied())
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

/// Another index: golden-section steps spread over all of them without a pattern.
fn elsewhere(one: usize, turn: usize, count: usize) -> usize {
    let step = 1.0 + (count as f64 - 1.0) * (0.618_034 * turn as f64).fract();
    (one + step as usize) % count
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use posecut_geometry::SE2;
    use posecut_pcm::generate::{Falsehood, Scenario};

    use super::*;

    /// Two groups of false edges among correct ones were accepted, because nothing compared them (simulated session
    /// 2012-02-02, corridor).
    #[test]
    fn partners_lie_near_in_between_and_anywhere() {
        let scenario = Scenario { candidates: 200, outliers: 0.0, falsehood: Falsehood::Uniform, seed: 3 };
        let graph = scenario.draw::<SE2, 3>();
        let model = Model::<SE2, 3>::of(&graph, &[]).unwrap();
        let partners = Partners::of(&model);
        let place = |closure: usize| {
            let edge = &graph.edges[model.closures[closure].candidate.edge];
            [edge.from as f64, edge.to as f64]
        };
        for closure in 0..200 {
            // Steps of these chains have similar lengths, so ranks follow the number of steps, except among close neighbours.
            let apart = |other: &usize| {
                let ([a, b], [c, d]) = (place(closure), place(*other));
                (a - c).abs() + (b - d).abs()
            };
            let near = partners.near(closure).iter().map(apart).fold(0.0, f64::max);
            let middle: Vec<f64> = partners.middle[closure].iter().map(apart).collect();
            assert_eq!((partners.near(closure).len(), middle.len()), (NEAR, MIDDLE.len()));
            assert!(middle[0] > near && middle[2] > 2.0 * near, "{closure}: {near} and {middle:?}");
            assert!(partners.all(closure).all(|other| other != closure && other < 200));
        }
        let near = Model::<SE2, 3>::of(&graph, &[Ingredient::FarPartners]).unwrap();
        assert_eq!(Partners::of(&near).all(7).count(), NEAR);
    }
}

//! The first pass: verdicts by the multicut alone, before any map is optimised.

use rayon::prelude::*;

use crate::calibration::Calibration;
use crate::cut::{COST, Tie, cut, tied};
use crate::factors::Factors;
use crate::ingredients::Ingredient;
use crate::islands::{Hypothesis, islands, support};
use crate::model::{Model, Motion};
use crate::partners::Partners;

/// Clusters of closures that agree with each other, and the conclusions from them alone.
pub(crate) struct FirstPass {
    /// Evidence of the pairs compared.
    pub(crate) ties: Vec<Tie>,
    /// Bound on the excess of the multicut's cost over the minimum, as a share of it.
    pub(crate) cut_gap: f64,
    /// Evidence above which one closure is unlikely to agree by chance, nats.
    pub(crate) threshold: f64,
    /// Log-likelihood ratio of each closure against the odometry of its own chain, where there is one.
    pub(crate) ratio: Vec<Option<f64>>,
    /// Whether each closure is in one cluster with its odometry, with enough evidence.
    pub(crate) accepted: Vec<bool>,
    /// Groups that agree with each other, the heaviest first.
    pub(crate) hypotheses: Vec<Hypothesis>,
}

impl FirstPass {
    /// Compares all partners and cuts.
    pub(crate) fn of<G: Motion<DOF>, const DOF: usize>(
        model: &Model<G, DOF>,
        partners: &Partners,
        factors: &Factors,
    ) -> Self {
        let calibration = &factors.loops;
        let ties = ties(model, partners, calibration);
        let count = model.closures.len();
        let ratio: Vec<Option<f64>> = (0..count)
            .map(|closure| Some(factors.single.evidence(&model.single(closure)?)?.distant()))
            .collect();
        let bound = |trials: f64| (COST * trials * (1.0 - calibration.correct)).max(1.0).ln();
        let threshold = bound(count as f64);
        let chains = model.chains.chains.len();
        let anchored: Vec<Option<(usize, f64)>> = ratio
            .iter()
            .enumerate()
            .map(|(closure, ratio)| ratio.map(|ratio| (model.span(closure).a, ratio)))
            .collect();
        let together = if model.without(Ingredient::Multicut) { tied } else { cut };
        let clusters = together(count, chains, &ties, &anchored, calibration.correct);
        let support = support(&clusters, &ties, &anchored);
        // A tightly connected island has only one chance to agree by chance, so the bound counts islands instead of closures.
        let close = islands(&clusters, &ties, &support, threshold, threshold);
        let loose = bound(close.count(&support, threshold) as f64);
        let islands = islands(&clusters, &ties, &support, threshold, loose);
        let best = islands.best(&ratio);
        // The members of an island share odometry, so their evidence against the chain counts once: that of the best member.
        let anchored_well = |closure: usize| {
            anchored[closure]
                .is_some_and(|(anchor, _)| clusters.labels[closure] == clusters.labels[count + anchor])
                && support[closure] > threshold
                && best[islands.forest.find(closure)] > loose
        };
        let accepted = (0..count).map(anchored_well).collect();
        let hypotheses = islands.hypotheses(threshold);
        Self { accepted, hypotheses, cut_gap: clusters.gap, ties, threshold, ratio }
    }
}

/// The evidence of each pair of partners.
fn ties<G: Motion<DOF>, const DOF: usize>(
    model: &Model<G, DOF>,
    partners: &Partners,
    calibration: &Calibration,
) -> Vec<Tie> {
    let mut pairs: Vec<(usize, usize)> = (0..model.closures.len())
        .flat_map(|one| partners.all(one).map(move |other| (one.min(other), one.max(other))))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
        .into_par_iter()
        .filter_map(|(one, other)| {
            let evidence = calibration.evidence(&model.pair(one, other))?;
            Some(Tie { one, other, ratio: evidence.weight() })
        })
        .collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use std::f64::consts::FRAC_PI_2;
    use std::fmt::Write as _;

    use posecut_geometry::{LieGroup as _, SE2};
    use posecut_graph::PoseGraph;
    use posecut_stage::random;
    use rand::{Rng, RngExt as _};
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;

    /// Steps of one side of a square, of one lap around it, and of all laps.
    const SIDE: usize = 40;
    const LAP: usize = 4 * SIDE;
    const STEPS: usize = 6 * LAP;
    /// Standard deviations of a step and of a landmark edge, metres and radians. Odometry claims twice its own.
    const STEP: [f64; 2] = [0.01, 0.002];
    const LANDMARK: [f64; 2] = [0.03, 0.01];

    fn normal(random: &mut impl Rng, deviation: f64) -> f64 {
        let unit: f64 = StandardNormal.sample(random);
        deviation * unit
    }

    fn noise(random: &mut impl Rng, [along, turn]: [f64; 2]) -> SE2 {
        SE2::new(normal(random, along), normal(random, along), normal(random, turn))
    }

    fn edge(kind: &str, [id, from, to]: [usize; 3], motion: &SE2, deviations: [f64; 2]) -> String {
        let ([x, y, _], turn) = (motion.translation(), motion.angle());
        let [along, around] = deviations.map(|deviation| deviation.powi(-2));
        format!(
            "{{\"kind\":\"{kind}\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[{x},{y},{turn}],\"information\":[{along},0,0,{along},0,{around}]}}\n"
        )
    }

    /// Six laps of a square, with landmark edges to earlier laps. In each lap the heading drifts by a constant of its own, which odometry
    /// does not know: between neighbouring edges the drift is less than the noise, over a lap it is twenty times as much.
    fn laps(seed: u64) -> PoseGraph {
        let random = &mut random(seed, "laps");
        let mut truth = vec![SE2::identity()];
        let mut text =
            "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
        for id in 0..=STEPS {
            writeln!(text, "{{\"kind\":\"node\",\"id\":{id}}}").unwrap();
        }
        let mut drift = 0.0;
        for step in 0..STEPS {
            if step % LAP == 0 {
                drift = normal(random, 0.003);
            }
            let turn = if step % SIDE == SIDE - 1 { FRAC_PI_2 } else { 0.0 };
            let motion = SE2::new(1.0, 0.0, turn);
            truth.push(truth[step].compose(&motion));
            let measured = motion.compose(&noise(random, STEP)).compose(&SE2::new(0.0, 0.0, drift));
            text +=
                &edge("odometry", [step, step, step + 1], &measured, STEP.map(|deviation| 2.0 * deviation));
        }
        for to in (LAP..STEPS).step_by(2) {
            let from = to % LAP + LAP * random.random_range(0..to / LAP);
            let measured = truth[from].between(&truth[to]).compose(&noise(random, LANDMARK));
            text += &edge("landmark", [STEPS + to, from, to], &measured, LANDMARK);
        }
        PoseGraph::read("laps", text.as_bytes()).unwrap()
    }

    /// The median squared distance of the loops of candidates with the odometry of their chain.
    fn distance(model: &Model<SE2, 3>, factors: &Calibration) -> f64 {
        let loops = (0..model.closures.len()).map(|closure| model.single(closure).unwrap());
        let mut distances: Vec<f64> =
            loops.map(|closed| factors.evidence(&closed).unwrap().squared_distance).collect();
        distances.sort_by(f64::total_cmp);
        distances[distances.len() / 2]
    }

    /// One factor for all odometry is that of short stretches, of which there are more. Correct edges then contradicted odometry, and 696
    /// of the 856 of the laser log intel were rejected. The median of chi-square of three degrees of freedom is 2.4.
    #[test]
    fn odometry_that_drifts_far_beyond_its_covariance_does_not_contradict_correct_edges() {
        let distances = (1..=4).map(|seed| {
            let model = Model::<SE2, 3>::of(&laps(seed), &[]).unwrap();
            let factors = Factors::of(&model, &Partners::of(&model));
            [&factors.single, &factors.loops].map(|factors| distance(&model, factors))
        });
        let distances: Vec<[f64; 2]> = distances.collect();
        assert!(distances.iter().all(|[single, _]| (0.5..8.0).contains(single)), "{distances:?}");
        assert!(distances.iter().any(|[_, loops]| *loops > 20.0), "{distances:?}");
    }
}

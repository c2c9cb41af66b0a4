//! How far covariances are wrong, for each chain, estimated from loops in contrast to shuffled loops.

use nalgebra::SMatrix;
use rayon::prelude::*;
use serde::Serialize;

use crate::evidence::{Evidence, GAUSSIAN, TAIL, compare};
use crate::ingredients::Ingredient;
use crate::mixture::{Class, Contrast, Loops, SAMPLE, classes, contrast, local_share};
use crate::model::{Loop, Model, Motion};
use crate::partners::Partners;

/// Factors on covariances.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// For each chain, the factor on the covariance of its odometry.
    pub odometry: Vec<f64>,
    /// For each chain, the variance of a coherent error, as the square of a share of the distance travelled.
    pub coherent: Vec<f64>,
    /// The factor on the covariance of landmark edges.
    pub landmark: f64,
    /// Estimated share of correct candidates.
    pub correct: f64,
    /// Counted ratio of local errors (a landmark edge is wrong by up to thirty standard deviations) to correct loops.
    pub local: f64,
    /// Evidence of the loops above that of shuffled ones, nats.
    pub evidence: f64,
    /// Whether the evidence was too little for an estimate, so that covariances are used as claimed.
    pub on_prior: bool,
    /// A further factor on the covariance of odometry for loops through neighbours of one chain.
    #[serde(skip)]
    pub(crate) short: f64,
    /// Degrees of freedom of the t distribution of errors.
    #[serde(skip)]
    pub(crate) tail: f64,
}

/// Factors for each use of odometry.
#[derive(Clone, Debug)]
pub(crate) struct Factors {
    /// For loops through two candidates.
    pub(crate) loops: Calibration,
    /// For the loop of a candidate with the odometry of its own chain. Errors are not independent from step to step: over a whole chain,
    /// they may add up to many times what neighbours show. Here neighbours have a factor of their own.
    pub(crate) single: Calibration,
    /// For the map, without coherent errors: the optimiser takes errors as independent per step.
    pub(crate) random: Calibration,
}

impl Factors {
    pub(crate) fn of<G: Motion<DOF>, const DOF: usize>(model: &Model<G, DOF>, partners: &Partners) -> Self {
        let classes = classes(model, partners);
        let mut axes = vec![Axis::Odometry];
        axes.extend((!model.without(Ingredient::Coherent)).then_some(Axis::Coherent));
        axes.push(Axis::Landmark);
        let separate = !model.without(Ingredient::ShortStretches) && classes.iter().any(Class::is_short);
        let with_short = [&axes[..], &[Axis::Short]].concat();
        let (loops, (single, random)) = rayon::join(
            || calibrate(model, &classes, &axes),
            || {
                rayon::join(
                    || separate.then(|| calibrate(model, &classes, &with_short)),
                    || calibrate(model, &classes, &[Axis::Odometry, Axis::Landmark]),
                )
            },
        );
        Self { single: single.unwrap_or_else(|| loops.clone()), loops, random }
    }

    /// The same factors for chains that are pieces of the calibrated ones. `whole` has the calibrated chain of each piece.
    pub(crate) fn of_parts(&self, whole: &[usize]) -> Self {
        Self {
            loops: self.loops.of_parts(whole),
            single: self.single.of_parts(whole),
            random: self.random.of_parts(whole),
        }
    }
}

/// Variance of a local error over that of landmark noise: thirty standard deviations, squared.
const LOCAL: f64 = 900.0;

impl Calibration {
    /// Whether the factor of landmark edges is the smallest one allowed: the loops may ask for a smaller one.
    pub fn is_landmark_least(&self) -> bool {
        // exp(ln(x)) differs from x by rounding.
        self.landmark <= LANDMARK_LEAST * (1.0 + 1e-9)
    }

    /// The factor that turns the claimed covariance of a loop's landmark edges into that of a local error, never below the
    /// claim times `LOCAL`. A narrower local error would explain gross errors of odometry, and make all other noise small.
    pub(crate) fn local_factor(&self) -> f64 {
        self.landmark.max(1.0) * LOCAL
    }

    /// The covariance of a local error of a loop's landmark edges.
    pub(crate) fn local<const DOF: usize>(
        &self,
        landmark: &SMatrix<f64, DOF, DOF>,
    ) -> SMatrix<f64, DOF, DOF> {
        landmark * self.local_factor()
    }

    pub(crate) fn covariance<const DOF: usize>(&self, closed: &Loop<DOF>) -> SMatrix<f64, DOF, DOF> {
        let mut sum = closed.landmark * self.landmark;
        for (chain, random, coherent) in &closed.odometry {
            sum += random * self.odometry[*chain] + coherent * self.coherent[*chain];
        }
        sum
    }

    /// The evidence of a loop; `None` where its covariance is not positive definite.
    pub(crate) fn evidence<const DOF: usize>(&self, closed: &Loop<DOF>) -> Option<Evidence> {
        let local = self.local(&closed.landmark);
        compare(&closed.error, &self.covariance(closed), &closed.apart, &local, self.tail)
    }

    /// The same calibration with these factors for all chains.
    fn with(&self, point: Point) -> Self {
        let chains = self.odometry.len();
        Self {
            odometry: vec![point.odometry.exp(); chains],
            coherent: vec![point.coherent.exp(); chains],
            landmark: point.landmark.exp(),
            short: point.short.exp(),
            ..*self
        }
    }

    /// The same calibration for loops through neighbours of one chain.
    pub(crate) fn over_short(&self) -> Self {
        Self { odometry: self.odometry.iter().map(|factor| factor * self.short).collect(), ..self.clone() }
    }

    fn of_parts(&self, whole: &[usize]) -> Self {
        let part = |factors: &[f64]| whole.iter().map(|&chain| factors[chain]).collect();
        Self { odometry: part(&self.odometry), coherent: part(&self.coherent), ..*self }
    }

    /// Odds of a local error against a correct closure, from the log-likelihood ratio of a correct closure against a local error.
    pub(crate) fn wrong(&self, against_local: f64) -> f64 {
        self.local * (-against_local).exp()
    }

    /// Prior odds that a candidate is correct.
    pub(crate) fn odds(&self) -> f64 {
        self.correct / (1.0 - self.correct)
    }
}

/// Factor on the prior odds of a candidate that neither the map nor another candidate can judge. Correct candidates mostly
/// have company: one among all accepted candidates is assumed to be alone, compared with the share of unjudged ones among the
/// others.
pub(crate) fn alone(ratio: &[Option<f64>], accepted: &[bool]) -> f64 {
    let silent = ratio.iter().zip(accepted).filter(|(ratio, accepted)| ratio.is_none() && !**accepted);
    let silent = silent.count() as f64;
    let agreed = accepted.iter().filter(|accepted| **accepted).count() as f64;
    let others = accepted.len() as f64 - agreed;
    (others + 1.0) / (silent + 1.0) / (agreed + 1.0)
}

/// Prior standard deviation of the logarithm of a factor.
const PRIOR: f64 = 2.0;
/// The same of a chain's own factor relative to the common one.
const PRIOR_CHAIN: f64 = 1.0;
/// The coherent variance with the highest prior, and the largest one allowed.
const COHERENT: f64 = 1e-6;
const COHERENT_MOST: f64 = 1e-2;
/// A coherent variance without effect.
const NEGLIGIBLE: f64 = 1e-12;
/// The smallest factor of landmark edges. Neighbouring keyframes share scans, so their measurements agree with each other better than with
/// the world: loops through two of them ask for a factor near 0.01 on the log intel. Six edges, all off by the same 5 m, then bent the map.
const LANDMARK_LEAST: f64 = 0.1;
/// Evidence below which covariances are used as claimed, nats.
const LEAST_EVIDENCE: f64 = 10.0;

#[derive(Clone, Copy, Debug)]
struct Point {
    odometry: f64,
    landmark: f64,
    coherent: f64,
    short: f64,
}

/// A factor that the ascent moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    Odometry,
    Landmark,
    Coherent,
    Short,
}

/// Estimates the common factors first, then those of each chain.
fn calibrate<G: Motion<DOF>, const DOF: usize>(
    model: &Model<G, DOF>,
    classes: &[Class<DOF>],
    axes: &[Axis],
) -> Calibration {
    let with_coherent = axes.contains(&Axis::Coherent);
    let chains = model.chains.chains.len();
    let coherent = if with_coherent { COHERENT } else { NEGLIGIBLE };
    let mut calibration = Calibration {
        odometry: vec![1.0; chains],
        coherent: vec![coherent; chains],
        landmark: 1.0,
        short: 1.0,
        correct: 0.5,
        local: 0.0,
        evidence: 0.0,
        on_prior: true,
        tail: if model.without(Ingredient::HeavyTails) { GAUSSIAN } else { TAIL },
    };
    let candidates = model.closures.len();
    let loops: usize = classes.iter().map(|class| class.real.len()).sum();
    if loops == 0 || model.without(Ingredient::Calibration) {
        return calibration;
    }
    // Loops through the same closures are not independent, so each counts for less.
    let tempering = (candidates.min(SAMPLE) as f64 / loops as f64).min(1.0);
    let starts = [(0.0, 0.0), (-4.0, 0.0), (4.0, 0.0), (0.0, 5.0), (0.0, LANDMARK_LEAST.ln())]
        .map(|(odometry, landmark)| Point { odometry, landmark, coherent: coherent.ln(), short: 0.0 });
    let best = highest(&starts, axes, |point, loops| {
        let found = contrast(classes, &calibration.with(point), tempering, loops);
        let prior = square(point.odometry / PRIOR)
            + square(point.landmark / PRIOR)
            + square((point.coherent - coherent.ln()) / (2.0 * PRIOR))
            + square(point.short / PRIOR);
        Contrast { objective: found.objective - 0.5 * prior, ..found }
    });
    let Some((point, Contrast { evidence, correct, .. })) = best else { return calibration };
    calibration.evidence = evidence;
    calibration.correct = correct;
    calibration.local = local_share(classes, &calibration.with(point));
    calibration.on_prior = evidence < LEAST_EVIDENCE;
    if !calibration.on_prior {
        calibration = calibration.with(point);
        refine(&mut calibration, classes, tempering, with_coherent);
    }
    calibration
}

/// Estimates the factors of each chain from the loops that it takes part in, near the common factors.
fn refine<const DOF: usize>(
    calibration: &mut Calibration,
    classes: &[Class<DOF>],
    tempering: f64,
    with_coherent: bool,
) {
    let chains = calibration.odometry.len();
    if chains < 2 {
        return;
    }
    let common = (calibration.odometry[0].ln(), calibration.coherent[0].ln());
    let owned: Vec<Vec<_>> =
        (0..chains).map(|chain| classes.iter().map(|class| class.of(chain)).collect()).collect();
    // The second pass starts each chain from its current factors, because those of the other chains have changed.
    for starts in [2, 1] {
        for (chain, own) in owned.iter().enumerate() {
            if own.iter().all(|class| class.real.is_empty()) {
                continue;
            }
            let now = (calibration.odometry[chain].ln(), calibration.coherent[chain].ln());
            let all = [now, (common.0 + 4.0, common.1)].map(|(odometry, coherent)| Point {
                odometry,
                landmark: 0.0,
                short: 0.0,
                coherent,
            });
            let axes: &[Axis] =
                if with_coherent { &[Axis::Odometry, Axis::Coherent] } else { &[Axis::Odometry] };
            let best = highest(&all[..starts], axes, |point, loops| {
                let mut factors = calibration.clone();
                factors.odometry[chain] = point.odometry.exp();
                factors.coherent[chain] = point.coherent.exp();
                let found = contrast(own, &factors, tempering, loops);
                let prior = square((point.odometry - common.0) / PRIOR_CHAIN)
                    + square((point.coherent - common.1) / PRIOR_CHAIN);
                Contrast { objective: found.objective - 0.5 * prior, ..found }
            });
            if let Some((point, _)) = best {
                calibration.odometry[chain] = point.odometry.exp();
                calibration.coherent[chain] = point.coherent.exp();
            }
        }
    }
}

fn square(value: f64) -> f64 {
    value * value
}

/// Coordinate ascent with steps that halve. Coarse steps over a sample of the loops run from every start; fine steps over all
/// loops then continue from the best result.
fn highest(
    starts: &[Point],
    axes: &[Axis],
    objective: impl Fn(Point, Loops) -> Contrast + Sync,
) -> Option<(Point, Contrast)> {
    let (some, all) = (|point| objective(point, Loops::Some), |point| objective(point, Loops::All));
    let ascended = starts.par_iter().map(|&start| {
        let (point, _) = ascend((start, some(start)), axes, &[2.0, 1.0], some);
        (point, all(point))
    });
    // The first of the highest, independent of the order in which threads finish.
    let best = ascended
        .collect::<Vec<_>>()
        .into_iter()
        .reduce(|best, found| if found.1.objective > best.1.objective { found } else { best });
    best.map(|best| ascend(best, axes, &[1.0, 0.5, 0.25, 0.125], all))
}

fn ascend(
    start: (Point, Contrast),
    axes: &[Axis],
    steps: &[f64],
    objective: impl Fn(Point) -> Contrast,
) -> (Point, Contrast) {
    let (mut point, mut value) = start;
    // Points already evaluated were not higher.
    let mut seen = vec![point];
    for step in steps {
        let mut improved = true;
        while improved {
            improved = false;
            for (&axis, direction) in axes.iter().flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
                let trial = point.moved(axis, direction * step);
                if seen.iter().any(|seen| seen.is(&trial)) {
                    continue;
                }
                seen.push(trial);
                let found = objective(trial);
                if found.objective > value.objective + 1e-9 {
                    (point, value, improved) = (trial, found, true);
                }
            }
        }
    }
    (point, value)
}

impl Point {
    /// Whether two points are equal up to rounding.
    fn is(&self, other: &Self) -> bool {
        let apart = [
            self.odometry - other.odometry,
            self.landmark - other.landmark,
            self.coherent - other.coherent,
            self.short - other.short,
        ];
        apart.iter().all(|apart| apart.abs() < 1e-9)
    }

    fn moved(mut self, axis: Axis, by: f64) -> Self {
        match axis {
            Axis::Odometry => self.odometry += by,
            Axis::Landmark => self.landmark = (self.landmark + by).max(LANDMARK_LEAST.ln()),
            Axis::Short => self.short += by,
            Axis::Coherent => self.coherent = (self.coherent + 2.0 * by).min(COHERENT_MOST.ln()),
        }
        self
    }
}

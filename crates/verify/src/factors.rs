//! The factors of a calibration, estimated from loops in contrast to shuffled loops.

use crate::ascent::{Axis, EXCEPTION, LANDMARK_LEAST, Point, WIDEST, highest};
use crate::calibration::{Calibration, LocalErrors};
use crate::evidence::{GAUSSIAN, TAIL};
use crate::ingredients::Ingredient;
use crate::mixture::{Class, Contrast, SAMPLE, classes, contrast, local_share};
use crate::model::{Model, Motion};
use crate::partners::Partners;

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
        let peak = |axes: &[Axis], errors| peak(model, &classes, axes, errors);
        let further = |errors| {
            rayon::join(
                || separate.then(|| peak(&with_short, errors).refined(&classes)),
                || peak(&[Axis::Odometry, Axis::Landmark], errors).refined(&classes),
            )
        };
        let (exceptions, common) =
            (LocalErrors::Exceptions, LocalErrors::Common { translation: EXCEPTION, turning: EXCEPTION });
        let (loops, mut rest) = rayon::join(
            || {
                let (usual, other) = rayon::join(
                    || peak(&axes, exceptions),
                    || (!model.without(Ingredient::Local)).then(|| peak(&axes, common)),
                );
                other.filter(|other| other.is_preferred_to(&usual)).unwrap_or(usual).refined(&classes)
            },
            || further(exceptions),
        );
        if loops.errors != exceptions {
            rest = further(common);
        }
        let (single, random) = rest;
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

/// How much better than exceptions common local errors must explain all loops, nats. On 250 simulated graphs with wrong edges of four kinds,
/// about as many wrong edges were accepted with 3 and 5 nats, and 7 % more with 10.
const COMMON: f64 = 5.0;
/// How much better than exceptions common local errors must explain all loops, nats for each candidate, if they come out wider than
/// exceptions or if no noise becomes smaller with them. Such errors explain loops a little better than they should where noise has two
/// sizes, as with heavy tails, or where odometry drifts beyond all factors, and then correct edges would be left out. Values from 0.35 to
/// 1 leave out about as many (798 to 828 on 180 drawn graphs) and accept 326 to 369 wrong ones; 0.2 loses 61 closures of bicocca.
const MUCH_BETTER: f64 = 0.35;
/// How much larger the factor on landmark noise, or the coherent variance, must be without common local errors: three standard deviations,
/// squared.
const INFLATED: f64 = 9.0;
/// The same for the factor on odometry, which all loops inform. It explains errors of metres as drift over long loops.
const INFLATED_ODOMETRY: f64 = 5.0;
/// Prior standard deviation of the logarithm of a factor.
const PRIOR: f64 = 2.0;
/// The same of a chain's own factor relative to the common one.
const PRIOR_CHAIN: f64 = 1.0;
/// The coherent variance with the highest prior.
const COHERENT: f64 = 1e-6;
/// A coherent variance without effect.
const NEGLIGIBLE: f64 = 1e-12;
/// Evidence below which covariances are used as claimed, nats.
const LEAST_EVIDENCE: f64 = 10.0;

impl Calibration {
    /// Whether local errors are common and narrower than this factor on the claimed covariance.
    fn has_errors_below(&self, limit: f64) -> bool {
        // exp(ln(x)) differs from x by rounding.
        matches!(self.errors, LocalErrors::Common { translation, .. } if translation < limit * (1.0 - 1e-9))
    }

    /// Whether some noise is much larger in the other explanation: that of landmark edges, of odometry, or its drift.
    fn has_less_noise_than(&self, other: &Self) -> bool {
        // Of the common factors, all chains have the same.
        let drift = self.coherent.first().zip(other.coherent.first());
        let odometry = self.odometry.first().zip(other.odometry.first());
        other.landmark > INFLATED * self.landmark
            || odometry.is_some_and(|(own, other)| *other > INFLATED_ODOMETRY * own)
            || drift.is_some_and(|(own, other)| *other > INFLATED * own.max(COHERENT))
    }

    /// Whether landmark edges are much noisier here than they claim and than in the other explanation. On sphere_a, whose edges are all correct,
    /// a factor of 90 on landmark edges with local errors seven times as wide explains as much as one of 150 on odometry.
    fn has_noisier_edges_than(&self, other: &Self) -> bool {
        self.landmark > INFLATED * other.landmark.max(1.0)
    }
}

/// The best common factors.
struct Peak {
    calibration: Calibration,
    /// Their log-posterior, tempered.
    objective: f64,
    tempering: f64,
    with_coherent: bool,
    /// The number of candidates whose loops were looked at.
    sampled: usize,
}

impl Peak {
    /// Whether common local errors explain the loops so much better than exceptions that noise was mistaken there.
    fn is_preferred_to(&self, exceptions: &Self) -> bool {
        let (own, other) = (&self.calibration, &exceptions.calibration);
        let gain = self.objective - exceptions.objective;
        let is_much_better = gain > MUCH_BETTER * self.sampled as f64;
        // Errors of the widest kind have no width of their own: they are more likely to be edges between the wrong places.
        own.has_errors_below(WIDEST)
            && gain > COMMON
            && !own.has_noisier_edges_than(other)
            && (is_much_better || (own.has_errors_below(EXCEPTION) && own.has_less_noise_than(other)))
    }

    /// The factors of each chain.
    fn refined<const DOF: usize>(self, classes: &[Class<DOF>]) -> Calibration {
        let mut calibration = self.calibration;
        if !calibration.on_prior {
            refine(&mut calibration, classes, self.tempering, self.with_coherent);
        }
        calibration
    }
}

/// Estimates the common factors.
fn peak<G: Motion<DOF>, const DOF: usize>(
    model: &Model<G, DOF>,
    classes: &[Class<DOF>],
    axes: &[Axis],
    errors: LocalErrors,
) -> Peak {
    let with_coherent = axes.contains(&Axis::Coherent);
    let with_local: &[Axis] =
        if errors == LocalErrors::Exceptions { &[] } else { &[Axis::Local, Axis::Turning] };
    let axes = &[axes, with_local].concat();
    let chains = model.chains.chains.len();
    let coherent = if with_coherent { COHERENT } else { NEGLIGIBLE };
    let mut calibration = Calibration {
        odometry: vec![1.0; chains],
        coherent: vec![coherent; chains],
        landmark: 1.0,
        errors,
        short: 1.0,
        correct: 0.5,
        local: 0.0,
        evidence: 0.0,
        on_prior: true,
        tail: if model.without(Ingredient::HeavyTails) { GAUSSIAN } else { TAIL },
    };
    let sampled = model.closures.len().min(SAMPLE);
    let loops: usize = classes.iter().map(|class| class.real.len()).sum();
    if loops == 0 || model.without(Ingredient::Calibration) {
        return Peak { calibration, objective: 0.0, tempering: 0.0, with_coherent, sampled };
    }
    // Loops through the same closures are not independent, so each counts for less.
    let tempering = (sampled as f64 / loops as f64).min(1.0);
    let starts = [(0.0, 0.0), (-4.0, 0.0), (4.0, 0.0), (0.0, 5.0), (0.0, LANDMARK_LEAST.ln())].map(
        |(odometry, landmark)| Point {
            odometry,
            landmark,
            coherent: coherent.ln(),
            short: 0.0,
            local: EXCEPTION.ln(),
            turning: 0.0,
        },
    );
    let best = highest(&starts, axes, |point, loops| {
        let found = contrast(classes, &calibration.with(point), tempering, loops);
        let prior = square(point.odometry / PRIOR)
            + square(point.landmark / PRIOR)
            + square((point.coherent - coherent.ln()) / (2.0 * PRIOR))
            + square(point.short / PRIOR)
            + square((point.local - EXCEPTION.ln()) / PRIOR)
            + square(point.turning / PRIOR);
        Contrast { objective: found.objective - 0.5 * prior, ..found }
    });
    let Some((point, Contrast { objective, evidence, correct })) = best else {
        return Peak { calibration, objective: 0.0, tempering, with_coherent, sampled };
    };
    calibration.evidence = evidence;
    calibration.correct = correct;
    calibration.local = local_share(classes, &calibration.with(point));
    calibration.on_prior = evidence < LEAST_EVIDENCE;
    if !calibration.on_prior {
        calibration = calibration.with(point);
    }
    Peak { calibration, objective, tempering, with_coherent, sampled }
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
                local: 0.0,
                turning: 0.0,
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

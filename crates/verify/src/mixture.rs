//! Loops as a mixture of correct ones, chance, and errors between the two, in contrast to the same loops shuffled.

use std::borrow::{Borrow, Cow};

use nalgebra::SMatrix;

use crate::calibration::{Calibration, LocalErrors};
use crate::ingredients::Ingredient;
use crate::likelihoods::{Likelihoods, Shares, counts, gain};
use crate::model::{Loop, Model, Motion};
use crate::neighbours::{Neighbours, RANKS};
use crate::packs::Sample;
use crate::partners::Partners;

/// Closures whose loops are sampled.
pub(crate) const SAMPLE: usize = 400;
/// Rounds of expectation maximisation.
const ROUNDS: usize = 12;

/// What the loops of a class are through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Through {
    /// One candidate within a chain.
    One,
    /// Two candidates between two chains.
    Two,
    /// Two neighbours within one chain, over short stretches of odometry. These inform only about noise, not about how many candidates are
    /// correct: wrong neighbours agree with each other, too.
    Neighbours,
}

/// Loops of one kind that share mixing proportions, with their shuffled twins.
#[derive(Clone)]
pub(crate) struct Class<const DOF: usize> {
    through: Through,
    /// Most local errors and shifts, relative to the correct loops, where they are exceptions, and where they are common.
    wrong_most: [f64; 2],
    /// Whether loops may be shifted. False closures between chains come in groups that agree with each other and lie the
    /// width of a corridor or a crossing beside the correct ones.
    shifted: bool,
    /// Whether the third explanation is wrong neighbours instead of a shift. Their number is not limited.
    neighbours: bool,
    pub(crate) real: Sample<DOF>,
    shuffled: Sample<DOF>,
}

/// Evidence of loops, compared with that of their shuffled twins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contrast {
    /// Log-likelihood of the mixture against chance alone, tempered; over all classes.
    pub(crate) objective: f64,
    /// The same over the classes that count correct candidates.
    pub(crate) evidence: f64,
    /// Share of correct loops in those classes.
    pub(crate) correct: f64,
}

/// Which loops to evaluate.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Loops {
    All,
    /// One in four where there are many; each then counts four times.
    Some,
}

impl Loops {
    fn step(self, count: usize) -> usize {
        match self {
            Self::Some if count >= MANY => 4,
            _ => 1,
        }
    }
}

/// Size of a class from which a quarter of its loops is enough to compare distant factors.
const MANY: usize = 400;

/// Loops through the same closures are not independent: each counts as `tempering` loops.
pub(crate) fn contrast<const DOF: usize>(
    classes: &[impl Borrow<Class<DOF>>],
    factors: &Calibration,
    tempering: f64,
    loops: Loops,
) -> Contrast {
    let (mut sum, mut evidence, mut correct) = (0.0, 0.0, 0.0);
    let mut counted = 0.0;
    for class in classes.iter().map(Borrow::borrow) {
        let step = loops.step(class.real.len());
        let [real, shuffled] = class.likelihoods(factors, step);
        let shares = class.shares(&real, factors.errors);
        let gained = step as f64 * (gain(&real, &shares) - gain(&shuffled, &shares).max(0.0));
        sum += gained;
        if !class.is_short() {
            evidence += gained;
            correct += shares[0] * class.real.len() as f64;
            counted += class.real.len() as f64;
        }
    }
    Contrast {
        objective: sum * tempering,
        evidence: evidence * tempering,
        correct: if counted > 0.0 { correct / counted } else { 0.5 },
    }
}

/// Ratio of local errors to correct loops, in the classes that count correct candidates.
pub(crate) fn local_share<const DOF: usize>(classes: &[Class<DOF>], factors: &Calibration) -> f64 {
    let (mut correct, mut local) = (0.0, 0.0);
    for class in classes.iter().filter(|class| !class.is_short()) {
        let [real, shuffled] = class.likelihoods(factors, 1);
        let shares = class.shares(&real, factors.errors);
        correct += shares[0] * class.real.len() as f64;
        // Some loops that close by chance look like local errors, as some shuffled loops do. Subtract those.
        let chance = 1.0 - shares.iter().sum::<f64>();
        let found = (counts(&real, &shares)[1] - chance * counts(&shuffled, &shares)[1]).max(0.0);
        local += if factors.errors == LocalErrors::Exceptions {
            found
        } else {
            class.of_candidates(found, &shares)
        };
    }
    if correct > 0.0 { local / correct } else { 0.0 }
}

impl<const DOF: usize> Class<DOF> {
    /// Adds the loop through two closures, and its twin, whose other closure gets the end of a third one `turn` steps away.
    /// `beside` replaces the second moment of the shift.
    fn add<G: Motion<DOF>>(
        &mut self,
        model: &Model<G, DOF>,
        (one, other): (usize, usize),
        turn: usize,
        beside: Option<SMatrix<f64, DOF, DOF>>,
    ) {
        let real = model.pair(one, other);
        let twin = model.pair_shuffled(one, other, Partners::elsewhere(model, other, turn));
        for (sample, closed) in [(&mut self.real, real), (&mut self.shuffled, twin)] {
            sample.push(Loop { beside: beside.unwrap_or(closed.beside), ..closed });
        }
    }

    /// Candidates with a local error for as many correct candidates as there are correct loops, from the number of `loops` with a local
    /// error. If a correct candidate comes with `r` that have a local error, a correct loop through two comes with `(1 + r)^2 - 1` that
    /// have one, because either candidate may have it.
    fn of_candidates(&self, loops: f64, shares: &Shares) -> f64 {
        let correct = shares[0] * self.real.len() as f64;
        if self.through == Through::One { loops } else { correct * ((1.0 + loops / correct).sqrt() - 1.0) }
    }

    /// Whether its loops are through neighbours of one chain.
    pub(crate) fn is_short(&self) -> bool {
        self.through == Through::Neighbours
    }

    /// The loops that a chain takes part in; between two chains, these are all loops.
    pub(crate) fn of(&self, chain: usize) -> Cow<'_, Self> {
        let takes_part = |closed: &Loop<DOF>| closed.odometry.iter().any(|(of, ..)| *of == chain);
        if self.real.loops().iter().all(takes_part) {
            return Cow::Borrowed(self);
        }
        let (mut real, mut shuffled) = (Sample::default(), Sample::default());
        for (closed, twin) in self.real.loops().iter().zip(self.shuffled.loops()) {
            if takes_part(closed) {
                real.push(closed.clone());
                shuffled.push(twin.clone());
            }
        }
        Cow::Owned(Self { real, shuffled, ..*self })
    }

    /// The likelihoods of every `step`-th pack of loops, and of their twins.
    fn likelihoods(&self, factors: &Calibration, step: usize) -> [Vec<Likelihoods>; 2] {
        let factors = if self.is_short() { Cow::Owned(factors.over_short()) } else { Cow::Borrowed(factors) };
        [&self.real, &self.shuffled].map(|sample| sample.likelihoods(&factors, self.shifted, step))
    }

    /// The mixing proportions, by expectation maximisation.
    fn shares(&self, loops: &[Likelihoods], errors: LocalErrors) -> Shares {
        let wrong_most = self.wrong_most[usize::from(errors != LocalErrors::Exceptions)];
        // Add one wrong and one correct loop to those counted, so that no share becomes certain.
        let unseen = [1.0, 0.5, if self.shifted { 0.5 } else { 0.0 }];
        let used: f64 = loops.iter().flat_map(|pack| pack.used.0).sum();
        let all = used + unseen.iter().sum::<f64>() + 1.0;
        let mut shares = [0.5, 0.05, if self.shifted { 0.05 } else { 0.0 }];
        for _ in 0..ROUNDS {
            let counts = counts(loops, &shares);
            shares = [0, 1, 2].map(|part| (unseen[part] + counts[part]) / all);
            let [correct, local, beside] = shares;
            let wrong = if self.neighbours { local } else { local + beside };
            if wrong > wrong_most * correct {
                let sum = correct + wrong;
                let correct = sum / (1.0 + wrong_most);
                let kept = (sum - correct) / wrong;
                shares = [correct, local * kept, if self.neighbours { beside } else { beside * kept }];
            }
        }
        shares
    }
}

/// The classes of loops: within a chain, single closures and neighbours; between chains, pairs of near and of random partners.
pub(crate) fn classes<G: Motion<DOF>, const DOF: usize>(
    model: &Model<G, DOF>,
    partners: &Partners,
) -> Vec<Class<DOF>> {
    let empty = |through, wrong_most, shifted| Class {
        through,
        wrong_most,
        shifted,
        neighbours: false,
        real: Sample::default(),
        shuffled: Sample::default(),
    };
    // Where four candidates in five have a local error, about one pair in twenty-five has none.
    let (of_single, of_pairs) = ([0.0, 4.0], [1.25, 16.0]);
    let (mut single, mut short) =
        (empty(Through::One, of_single, false), empty(Through::Neighbours, of_pairs, false));
    let shifted = !model.without(Ingredient::Shift);
    let (mut near, mut far) =
        (empty(Through::Two, of_pairs, shifted), empty(Through::Two, of_pairs, shifted));
    let count = model.closures.len();
    let sample = (0..count).step_by(count.div_ceil(SAMPLE).max(1));
    let neighbours = Neighbours::of(model, partners, sample.clone());
    near.neighbours = neighbours.known();
    near.shifted |= near.neighbours;
    for closure in sample {
        let donor = Partners::elsewhere(model, closure, 3);
        let found = partners.near(closure);
        let ranked =
            RANKS.iter().enumerate().filter_map(|(place, &rank)| Some((place, rank, *found.get(rank)?)));
        if let Some(closed) = model.single(closure) {
            single.real.push(closed);
            if let Some(twin) = model.single_shuffled(closure, donor) {
                single.shuffled.push(twin);
            }
            for (_, rank, other) in ranked.filter(|(place, ..)| *place != 1) {
                short.add(model, (closure, other), rank + 2, None);
            }
            continue;
        }
        for (place, rank, other) in ranked {
            near.add(model, (closure, other), rank + 2, neighbours.at(model, closure, place));
        }
        for (turn, &other) in partners.far(closure).iter().take(4).enumerate() {
            far.add(model, (closure, other), turn + 7, None);
        }
    }
    [single, short, near, far].into_iter().filter(|class| !class.real.is_empty()).collect()
}

//! The model of appearance on words that are drawn from it.

use posecut_random::rand::{Rng, RngExt};
use posecut_random::random;
use posecut_recognize::Words;
use posecut_recognize::appearance::{Appearance, Detector};

const WORDS: usize = 300;
const PLACES: usize = 150;

/// Two observations of each of many places: things exist independently, and a detector sees them.
fn visits(detector: Detector, seed: u64) -> Words {
    let mut random = random(seed, "words");
    let rates: Vec<f64> = (0..WORDS).map(|_| random.random_range(0.02..0.3)).collect();
    let places: Vec<Vec<bool>> =
        (0..PLACES).map(|_| rates.iter().map(|rate| random.random_bool(*rate)).collect()).collect();
    let observe = |place: &Vec<bool>, random: &mut dyn Rng| {
        (0..WORDS)
            .filter(|&word| {
                let marginal = rates[word] * detector.seen;
                let probability = if place[word] { detector.seen } else { detector.imagined * marginal };
                random.random_bool(probability)
            })
            .collect::<Vec<usize>>()
    };
    let mut bags: Vec<Vec<usize>> = places.iter().map(|place| observe(place, &mut random)).collect();
    bags.extend(places.iter().map(|place| observe(place, &mut random)).collect::<Vec<_>>());
    Words::new(bags, WORDS)
}

#[test]
fn the_place_that_was_seen_before_is_the_likeliest() {
    let detector = Detector { seen: 0.6, imagined: 0.3 };
    let words = visits(detector, 1);
    let model = Appearance::new(&words, detector);
    let mut right = 0;
    for place in 0..PLACES {
        let evidence = model.evidence(PLACES + place, |other| other < PLACES);
        let best =
            (0..PLACES).max_by(|one, other| evidence.ratio(*one).total_cmp(&evidence.ratio(*other))).unwrap();
        right += usize::from(best == place);
    }
    assert!(right > PLACES * 9 / 10, "only {right} of {PLACES} places were recognised");
}

#[test]
fn the_evidence_for_a_place_is_calibrated() {
    // With equal prior odds of this place and of another one, the posterior probability must be the share of true hypotheses.
    let detector = Detector { seen: 0.3, imagined: 0.3 };
    let words = visits(detector, 2);
    let model = Appearance::new(&words, detector);
    let (mut expected, mut found, mut count) = (0.0, 0.0, 0.0);
    for place in 0..PLACES {
        let evidence = model.evidence(PLACES + place, |other| other < PLACES);
        for (other, is_it) in [(place, 1.0), ((place + 1) % PLACES, 0.0)] {
            let probability = 1.0 / (1.0 + (-evidence.ratio(other)).exp());
            if (0.2..0.8).contains(&probability) {
                expected += probability;
                found += is_it;
                count += 1.0;
            }
        }
    }
    assert!(count > 20.0, "only {count} pairs are doubtful");
    let deviation = (0.25_f64 * count).sqrt();
    assert!((expected - found).abs() < 3.5 * deviation, "{expected} expected, {found} found of {count}");
}

#[test]
fn common_words_say_less_than_rare_ones() {
    // Word 0 is everywhere, word 1 at one place in ten.
    let bags = (0..100).map(|place| if place % 10 == 0 { vec![0, 1] } else { vec![0] }).collect();
    let words = Words::new(bags, 2);
    let model = Appearance::new(&words, Detector { seen: 0.6, imagined: 0.3 });
    let evidence = model.evidence(0, |other| other > 0);
    assert!(evidence.ratio(10) > evidence.ratio(11) + 0.5, "{} {}", evidence.ratio(10), evidence.ratio(11));
    assert!(evidence.ratio(11).abs() < 1.0);
}

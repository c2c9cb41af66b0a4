//! A fixed number of hostile inputs for every target, the same on every machine.

use posecut_fuzz::{Campaign, TARGETS, Target};

/// The number of inputs for each target: some seconds in total.
const INPUTS: u64 = 1_500;

fn none_panics_or_breaks_its_laws(targets: impl Iterator<Item = &'static Target>) {
    for target in targets {
        let mut campaign = Campaign::new(target, 1);
        for _ in 0..INPUTS {
            let input = campaign.input();
            if let Err(finding) = campaign.step(input) {
                panic!(
                    "{}, seed 1, input {}: {}\n{}",
                    target.name,
                    finding.number,
                    finding.message,
                    String::from_utf8_lossy(&finding.input)
                );
            }
        }
        assert!(
            campaign.outcomes() > 1,
            "{}: the inputs all end the same way, and test nothing",
            target.name
        );
    }
}

// Two tests, so that they run at the same time.
#[test]
fn no_target_at_an_even_place_panics_or_breaks_its_laws() {
    none_panics_or_breaks_its_laws(TARGETS.iter().step_by(2));
}

#[test]
fn no_target_at_an_odd_place_panics_or_breaks_its_laws() {
    none_panics_or_breaks_its_laws(TARGETS.iter().skip(1).step_by(2));
}

#[test]
fn a_campaign_is_fixed_by_its_seed() {
    let inputs = |seed| {
        let mut campaign = Campaign::new(&TARGETS[0], seed);
        (0..50)
            .map(|_| {
                let input = campaign.input();
                drop(campaign.step(input.clone()));
                input
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(inputs(1), inputs(1));
    assert_ne!(inputs(1), inputs(2));
}

#[test]
fn seeds_are_sound() {
    for target in TARGETS {
        let seeds = target.seeds();
        assert!(!seeds.is_empty(), "{}", target.name);
        let outcome = (target.read)(&seeds[0]);
        assert!(matches!(outcome, posecut_fuzz::Outcome::Read(_)), "{}: {outcome:?}", target.name);
    }
}

//! Many inputs for one target.

use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};

use posecut_stage::{ChaCha8Rng, random};
use rand::RngExt as _;

use crate::{Outcome, Target, mutate};

/// Longer inputs are cut to this length. Readers take linear time, so long inputs find nothing that short ones miss.
const LONGEST: usize = 1 << 15;

/// The number of inputs that are kept for their outcome. The seeds are the oldest inputs of the pool and always stay.
const LARGEST_POOL: usize = 2_000;

/// An input on which a target panicked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The number of the input in the campaign, from 0.
    pub number: u64,
    /// The message of the panic.
    pub message: String,
    /// The input.
    pub input: Vec<u8>,
}

/// A run of mutated inputs, fixed by its seed.
pub struct Campaign {
    target: &'static Target,
    pool: Vec<Vec<u8>>,
    seeds: usize,
    outcomes: HashSet<String>,
    random: ChaCha8Rng,
    number: u64,
}

impl Campaign {
    /// Starts from the target's seeds.
    pub fn new(target: &'static Target, seed: u64) -> Self {
        let pool = target.seeds();
        let seeds = pool.len();
        Self { target, pool, seeds, outcomes: HashSet::new(), random: random(seed, target.name), number: 0 }
    }

    /// Distinct outcomes so far.
    pub fn outcomes(&self) -> usize {
        self.outcomes.len()
    }

    /// The next input; the seeds themselves come first.
    pub fn input(&mut self) -> Vec<u8> {
        if let Some(seed) = self.pool.get(self.number as usize).filter(|_| self.number < self.seeds as u64) {
            return seed.clone();
        }
        let base = self.random.random_range(0..self.pool.len());
        let other = self.random.random_range(0..self.pool.len());
        let mut input = self.pool[base].clone();
        mutate(&mut input, &self.pool[other], self.target.words, &mut self.random);
        input.truncate(LONGEST);
        input
    }

    /// Gives an input to the target and learns from its outcome.
    pub fn step(&mut self, input: Vec<u8>) -> Result<(), Finding> {
        let number = self.number;
        self.number += 1;
        let target = self.target;
        match catch_unwind(AssertUnwindSafe(|| (target.read)(&input))) {
            Ok(outcome) => {
                if self.outcomes.insert(signature(&outcome)) && self.pool.len() < LARGEST_POOL {
                    self.pool.push(input);
                }
                Ok(())
            }
            Err(panic) => {
                let message = panic
                    .downcast_ref::<String>()
                    .cloned()
                    .or_else(|| panic.downcast_ref::<&str>().map(|&text| text.to_owned()))
                    .unwrap_or_default();
                Err(Finding { number, message, input })
            }
        }
    }
}

/// An outcome without its numbers and quoted text, which differ from input to input.
fn signature(outcome: &Outcome) -> String {
    let text = match outcome {
        Outcome::Read(what) => what,
        Outcome::Refused(why) => why,
    };
    let mut signature = String::new();
    let mut quoted = false;
    for character in text.chars() {
        if character == '"' {
            quoted = !quoted;
        }
        let digit = character.is_ascii_digit();
        if !(quoted || (digit && signature.ends_with('#'))) {
            signature.push(if digit { '#' } else { character });
        }
    }
    signature.truncate(signature.char_indices().nth(200).map_or(signature.len(), |(place, _)| place));
    signature
}

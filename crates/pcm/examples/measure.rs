//! Draws a scenario, solves it and prints one JSON line: seconds for pairs and clique, proof, precision and recall.
//!
//! Usage: measure CANDIDATES OUTLIERS uniform|grouped|near-miss 2|3 exact|cells SEED [P [GROW]]

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::time::Instant;

use clap::ValueEnum as _;
use posecut_geometry::{SE2, SE3};
use posecut_pcm::candidate::group;
use posecut_pcm::cells::solve_by_cells;
use posecut_pcm::chain::Chains;
use posecut_pcm::chance::{Acceptance, COST};
use posecut_pcm::clique::{Limits, maximum_clique};
use posecut_pcm::consistency::Pairs;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_pcm::growth::grow;
use posecut_pcm::{Gate, Spatial, Test};
use serde_json::json;

/// If the bounds leave a gap among tens of thousands of near misses, nodes cost milliseconds and close nothing.
const LIMITS: Limits = Limits { work: 2000, ..Limits::NONE };

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [candidates, outliers, falsehood, dimension, scheme, seed, rest @ ..] = &arguments[..] else {
        return Err(
            "usage: measure CANDIDATES OUTLIERS uniform|grouped|near-miss 2|3 exact|cells SEED [P [GROW]]"
                .into(),
        );
    };
    let scenario = Scenario {
        candidates: candidates.parse()?,
        outliers: outliers.parse()?,
        falsehood: Falsehood::from_str(falsehood, true)?,
        seed: seed.parse()?,
    };
    let probability = rest.first().map_or(Ok(0.99), |text| text.parse())?;
    let growth = rest.get(1).map(|text| text.parse()).transpose()?;
    if dimension == "2" {
        measure::<SE2, 3>(&scenario, scheme, probability, growth)
    } else {
        measure::<SE3, 6>(&scenario, scheme, probability, growth)
    }
}

fn measure<G: Spatial<DOF>, const DOF: usize>(
    scenario: &Scenario,
    scheme: &str,
    probability: f64,
    growth: Option<f64>,
) -> Result<(), Box<dyn std::error::Error>> {
    let graph = scenario.draw::<G, DOF>();
    let chains = Chains::<G, DOF>::of(&graph)?;
    let grouped = group(&graph, &chains)?;
    let group = grouped.groups.first().ok_or("no candidates")?;
    let gate = Gate::new(Test::Mahalanobis, probability, DOF)?;
    let start = Instant::now();
    let pairs = Pairs::new(&chains, group);
    let (members, grown, counts, upper_bound, work, seconds_pairs, seconds_clique);
    if scheme == "cells" {
        let solution = solve_by_cells(&pairs, gate, gate, 10.0, LIMITS, Acceptance::within_group(COST));
        (seconds_pairs, seconds_clique) = (0.0, start.elapsed().as_secs_f64());
        (members, grown, counts, upper_bound, work) =
            (solution.members, solution.grown, solution.counts, group.candidates.len(), solution.clique.work);
    } else {
        let (consistency, pair_counts) = pairs.graph(gate);
        seconds_pairs = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let clique = maximum_clique(&consistency, LIMITS);
        seconds_clique = start.elapsed().as_secs_f64();
        grown = match growth {
            Some(probability) => {
                grow(
                    &pairs,
                    &clique.vertices,
                    Gate::new(Test::Mahalanobis, probability, DOF)?,
                    Acceptance::within_group(COST),
                )
                .grown
            }
            None => Vec::new(),
        };
        (members, counts, upper_bound, work) =
            (clique.vertices, pair_counts, clique.upper_bound, clique.work);
    }
    let correct =
        |&candidate: &usize| graph.edges[group.candidates[candidate].edge].truth_correct() == Some(true);
    let all = (0..group.candidates.len()).filter(correct).count();
    let right = members.iter().chain(&grown).filter(|candidate| correct(candidate)).count();
    let kept = members.len() + grown.len();
    println!(
        "{}",
        json!({
            "candidates": group.candidates.len(), "scheme": scheme, "seconds_pairs": seconds_pairs,
            "seconds_clique": seconds_clique, "clique": members.len(), "upper_bound": upper_bound, "nodes": work,
            "grown": grown.len(), "pairs": counts.pairs,
            "skipped": (counts.skipped_by_rotation + counts.skipped_by_translation) as f64 / counts.pairs.max(1) as f64,
            "precision": right as f64 / kept.max(1) as f64, "recall": right as f64 / all.max(1) as f64,
        })
    );
    Ok(())
}

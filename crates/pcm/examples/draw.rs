//! Draws a scenario as a pose graph, to standard output.
//!
//! Usage: draw CANDIDATES OUTLIERS uniform|grouped|near-miss 2|3 SEED

use clap::ValueEnum as _;
use posecut_geometry::{SE2, SE3};
use posecut_pcm::generate::{Falsehood, Scenario};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [candidates, outliers, falsehood, dimension, seed] = &arguments[..] else {
        return Err("usage: draw CANDIDATES OUTLIERS uniform|grouped|near-miss 2|3 SEED".into());
    };
    let scenario = Scenario {
        candidates: candidates.parse()?,
        outliers: outliers.parse()?,
        falsehood: Falsehood::from_str(falsehood, true)?,
        seed: seed.parse()?,
    };
    let graph = if dimension == "2" { scenario.draw::<SE2, 3>() } else { scenario.draw::<SE3, 6>() };
    graph.write(std::io::BufWriter::new(std::io::stdout().lock()))?;
    Ok(())
}

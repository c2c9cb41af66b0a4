//! Writes a seeded graph in the mc format: one that resembles those of the pipeline, or one that is small and hard.

use std::io::Write as _;

use posecut_multicut::Graph;
use posecut_multicut::generate::{Family, generate};
use posecut_multicut::small_and_hard::{Drawing, cluster_editing, random_union};

const USAGE: &str = "usage: generate_mc F|S|A|D VIEWPOINTS SHARE-OF-FALSE-EDGES SEED FILE.mc
       generate_mc uniform|attachment COUNT NODES EDGES SEED FILE.mc
       generate_mc editing|weighted-editing NODES CLUSTERS SHARE-OF-FLIPPED-EDGES SEED FILE.mc";

fn draw(arguments: &[&str]) -> Result<Graph, Box<dyn std::error::Error>> {
    Ok(match *arguments {
        [kind @ ("uniform" | "attachment"), count, nodes, edges, seed] => {
            let drawing = if kind == "uniform" { Drawing::Uniform } else { Drawing::Attachment };
            random_union(drawing, count.parse()?, nodes.parse()?, edges.parse()?, seed.parse()?)?
        }
        [kind @ ("editing" | "weighted-editing"), nodes, clusters, flipped, seed] => {
            let weighted = kind == "weighted-editing";
            cluster_editing(nodes.parse()?, clusters.parse()?, flipped.parse()?, weighted, seed.parse()?)?
        }
        [family, viewpoints, incorrect, seed] => {
            let family = Family::from_letter(family).ok_or("the family is F, S, A or D")?;
            generate(family, viewpoints.parse()?, incorrect.parse()?, seed.parse()?)?
        }
        _ => return Err(USAGE.into()),
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((path, arguments)) = arguments.split_last() else { return Err(USAGE.into()) };
    let graph = draw(&arguments.iter().map(String::as_str).collect::<Vec<_>>())?;
    let mut output = std::io::BufWriter::new(std::fs::File::create(path)?);
    writeln!(output, "MULTICUT")?;
    for edge in graph.edges() {
        writeln!(output, "{} {} {}", edge.tail, edge.head, edge.cost)?;
    }
    output.flush()?;
    Ok(())
}

//! Writes a seeded graph that resembles those of the pipeline, in the mc format.

use std::io::Write as _;

use posecut_multicut::generate::{Family, generate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [family, viewpoints, incorrect, seed, path] = arguments.as_slice() else {
        return Err("usage: generate_mc F|S|A|D VIEWPOINTS SHARE-OF-FALSE-EDGES SEED FILE.mc".into());
    };
    let family = Family::from_letter(family).ok_or("the family is F, S, A or D")?;
    let graph = generate(family, viewpoints.parse()?, incorrect.parse()?, seed.parse()?)?;
    let mut output = std::io::BufWriter::new(std::fs::File::create(path)?);
    writeln!(output, "MULTICUT")?;
    for edge in graph.edges() {
        writeln!(output, "{} {} {}", edge.tail, edge.head, edge.cost)?;
    }
    output.flush()?;
    Ok(())
}

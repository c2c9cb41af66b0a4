//! Writes a benchmark graph in g2o with several starts.

use std::collections::HashMap;
use std::io::{BufRead as _, BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde_json::Value;

use crate::measure::optimize::pinned::{Pinned, converted, started, work};

/// The graph with the poses of the file, of odometry and of the chordal relaxation; vertices are numbered from 0.
pub(super) fn starts(name: &str) -> anyhow::Result<Vec<(&'static str, PathBuf)>> {
    let graph = work().join(format!("{name}.numbered.jsonl"));
    numbered(&converted(name)?, &graph)?;
    let mut found = Vec::new();
    for (start, initialisation) in [("file", "given"), ("odometry", "spanning-tree"), ("chordal", "chordal")]
    {
        let (poses, path) =
            (work().join(format!("{name}.{start}.jsonl")), work().join(format!("{name}.{start}.g2o")));
        started(&graph, initialisation, &poses)?;
        Pinned::posecut("convert").path(&poses).words(&["-o"]).path(&path).must()?;
        found.push((start, path));
    }
    Ok(found)
}

/// Numbers nodes from 0. It works line by line, because memory of this process counts towards the measured ones.
fn numbered(graph: &Path, output: &Path) -> anyhow::Result<()> {
    let place = || graph.display().to_string();
    let lines = || anyhow::Ok(BufReader::new(std::fs::File::open(graph).with_context(place)?).lines());
    let mut numbers = HashMap::new();
    for line in lines()? {
        let record: Value = serde_json::from_str(&line?).with_context(place)?;
        if record["kind"] == "node" {
            numbers.insert(record["id"].as_u64(), numbers.len());
        }
    }
    let number =
        |id: &Value| numbers.get(&id.as_u64()).copied().with_context(|| format!("{}: no node {id}", place()));
    let mut file = BufWriter::new(std::fs::File::create(output)?);
    for line in lines()? {
        let mut record: Value = serde_json::from_str(&line?).with_context(place)?;
        let fields: &[&str] = match record["kind"].as_str() {
            Some("node") => &["id"],
            _ if record.get("from").is_some() => &["from", "to"],
            _ => &[],
        };
        for field in fields {
            record[*field] = number(&record[*field])?.into();
        }
        writeln!(file, "{record}")?;
    }
    Ok(file.flush()?)
}

//! Writes the tf-idf similarity of the keyframes of each landmark edge as CSV, to standard output. The words are those from which
//! posecut-recognize computes `appearance` with its default settings.
//!
//! Usage: similarity GRAPH (the output of posecut-recognize, with scans)

use std::fs::File;
use std::io::{BufReader, Write as _};

use posecut_graph::{EdgeKind, PoseGraph};
use posecut_recognize::recognition::words_of_scans;
use posecut_recognize::tf_idf::TfIdf;
use posecut_recognize::{Routes, Settings, Submaps};
use posecut_scan::Scans;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: similarity GRAPH")?;
    let graph = PoseGraph::read(&path, BufReader::new(File::open(&path)?))?;
    let scans = Scans::of_graph(&graph)?;
    let routes = Routes::of_graph(&graph)?;
    let submaps = Submaps::new(&routes, graph.nodes.iter().map(|node| scans.at(node.id)).collect());
    let words = words_of_scans(&submaps, graph.nodes.len(), &Settings::DEFAULT);
    let index = TfIdf::new(&words);
    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    writeln!(output, "edge,similarity")?;
    for edge in graph.edges.iter().filter(|edge| edge.kind == EdgeKind::Landmark) {
        let (from, to) = graph.ends(edge).ok_or("an edge has no node")?;
        writeln!(output, "{},{}", edge.id, index.similarity(from, to))?;
    }
    Ok(())
}

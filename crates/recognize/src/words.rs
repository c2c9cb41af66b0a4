//! Bags of words: which words were seen at which keyframe.

use std::collections::BTreeMap;
use std::io::Read;

use anyhow::{Context as _, bail};
use posecut_graph::PoseGraph;
use serde::Deserialize;

/// The words of every keyframe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words {
    /// For each keyframe its words, ascending, each once; empty where nothing was seen.
    pub bags: Vec<Vec<usize>>,
    /// The number of different words.
    pub vocabulary: usize,
}

/// A line of a file of words.
#[derive(Deserialize)]
struct Line {
    node: u64,
    word: String,
}

impl Words {
    /// Of bags that may hold a word several times.
    pub fn new(mut bags: Vec<Vec<usize>>, vocabulary: usize) -> Self {
        for bag in &mut bags {
            bag.sort_unstable();
            bag.dedup();
        }
        Self { bags, vocabulary }
    }

    /// Reads a table with the columns `node` and `word` (CSV): the id of a keyframe, and any name of a word seen there. O(lines log lines).
    ///
    /// # Errors
    ///
    /// A line is not of that form, a node is not in the graph, or there is no line.
    pub fn read(graph: &PoseGraph, source_name: &str, reader: impl Read) -> anyhow::Result<Self> {
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        let mut bags = vec![Vec::new(); graph.nodes.len()];
        let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(reader);
        for (index, line) in table.deserialize().enumerate() {
            let place = || format!("{source_name}, line {}", index + 2);
            let line: Line = line.with_context(|| {
                format!("{source_name} is not a table of words; it needs a header line `node,word` and one line for each word seen")
            })?;
            let Some(node) = graph.node_index(line.node) else {
                bail!(
                    "{}: the graph has no node {}; use words of the keyframes of this graph",
                    place(),
                    line.node
                );
            };
            if line.word.is_empty() {
                bail!("{}: the word is empty; leave out lines without a word", place());
            }
            let next = numbers.len();
            bags[node].push(*numbers.entry(line.word).or_insert(next));
        }
        if numbers.is_empty() {
            bail!(
                "{source_name} has no words; it needs a header line `node,word` and one line for each word seen"
            );
        }
        Ok(Self::new(bags, numbers.len()))
    }

    /// Positions of up to `most` keyframes at equal distances among those that have words.
    pub fn sample(&self, most: usize) -> Vec<usize> {
        let with: Vec<usize> = (0..self.bags.len()).filter(|&node| !self.bags[node].is_empty()).collect();
        let step = (with.len() as f64 / most.max(1) as f64).max(1.0);
        let count = (with.len() as f64 / step).floor() as usize;
        (0..count).map(|number| with[(number as f64 * step) as usize]).collect()
    }
}

//! The instances: published ones, and those that the example `generate_mc` draws.

use std::path::{Path, PathBuf};
use std::process::Command;

use xtask::workspace::programs_folder;

use crate::process::must;

pub(super) const FAMILIES: [&str; 4] = ["F", "S", "A", "D"];
/// Shares of false edges.
pub(super) const RATES: [&str; 3] = ["0.1", "0.5", "0.9"];
const SEED: &str = "1";

pub(super) struct Instance {
    pub(super) name: String,
    pub(super) path: PathBuf,
    /// What the example `generate_mc` is asked for; empty for a published instance.
    drawn: Vec<String>,
    /// Number of viewpoints, for the families of the pipeline.
    pub(super) viewpoints: Option<u64>,
    /// The published optimum.
    pub(super) known: Option<f64>,
}

impl Instance {
    fn published(path: PathBuf, known: Option<f64>) -> Self {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Self { name, path, drawn: Vec::new(), viewpoints: None, known }
    }

    pub(super) fn is_drawn(&self) -> bool {
        !self.drawn.is_empty()
    }

    /// Writes the file of a generated instance.
    pub(super) fn generate(&self) -> anyhow::Result<()> {
        if self.is_drawn() {
            let mut generate = Command::new(programs_folder().join("examples/generate_mc"));
            must(generate.args(&self.drawn).arg(&self.path))?;
        }
        Ok(())
    }
}

/// Instances of the pipeline's kind, and published ones that are sparse or easy. The generated ones share one file in the folder.
pub(super) fn instances(largest: u64, folder: &Path) -> anyhow::Result<Vec<Instance>> {
    let mut all = Vec::new();
    match std::env::var_os("POSECUT_SHARED_DATA") {
        Some(data) => {
            for path in glob::glob(&Path::new(&data).join("multicut/*.mc").to_string_lossy())? {
                all.push(Instance::published(path?, None));
            }
        }
        None => eprintln!("skipped: no data: multicut (set POSECUT_SHARED_DATA)"),
    }
    for viewpoints in [1000, 10_000, 100_000, 1_000_000].into_iter().filter(|size| *size <= largest) {
        for family in FAMILIES.into_iter().filter(|family| *family != "D" || viewpoints <= 100_000) {
            for rate in RATES {
                let name = format!("{family} n={viewpoints} {rate}");
                let drawn = [family, &viewpoints.to_string(), rate, SEED].map(str::to_owned).to_vec();
                let path = folder.join("instance.mc");
                all.push(Instance { name, path, drawn, viewpoints: Some(viewpoints), known: None });
            }
        }
    }
    Ok(all)
}

/// Unions of fifty random graphs with real costs, and complete graphs of cluster editing: names and arguments of the generator.
const SMALL_AND_HARD: [(&str, &str); 8] = [
    ("uniform 50 x 60, 220 edges", "uniform 50 60 220 1"),
    ("uniform 50 x 60, 220 edges, seed 2", "uniform 50 60 220 2"),
    ("attachment 50 x 60, 220 edges", "attachment 50 60 220 1"),
    ("attachment 50 x 60, 220 edges, seed 2", "attachment 50 60 220 2"),
    ("editing 250, 5 clusters, 10 %", "editing 250 5 0.1 1"),
    ("editing 250, 10 clusters, 10 %", "editing 250 10 0.1 1"),
    ("weighted editing 250, 5 clusters, 10 %", "weighted-editing 250 5 0.1 1"),
    ("weighted editing 250, 10 clusters, 10 %", "weighted-editing 250 10 0.1 1"),
];

/// Small instances that are hard to prove: generated ones, and those of CP-Lib with their published optima.
pub(super) fn small_and_hard(folder: &Path) -> anyhow::Result<Vec<Instance>> {
    let mut all = Vec::new();
    for (name, arguments) in SMALL_AND_HARD {
        let drawn = arguments.split(' ').map(str::to_owned).collect();
        let (name, path) = (name.to_owned(), folder.join("instance.mc"));
        all.push(Instance { name, path, drawn, viewpoints: None, known: None });
    }
    let data = std::env::var_os("POSECUT_SHARED_DATA").map(|data| Path::new(&data).join("multicut/cplib"));
    let Some(data) = data.filter(|data| data.is_dir()) else {
        eprintln!("skipped: no data: multicut/cplib (set POSECUT_SHARED_DATA)");
        return Ok(all);
    };
    let optima = std::fs::read_to_string(data.join("optima.txt"))?;
    for line in optima.lines() {
        let mut words = line.split_whitespace();
        let (Some(name), Some(known)) = (words.next(), words.nth(1)) else { continue };
        let path = data.join(name).with_extension("mc");
        if path.exists() {
            all.push(Instance::published(path, Some(known.parse()?)));
        }
    }
    Ok(all)
}

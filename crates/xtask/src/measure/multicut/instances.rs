//! The instances: published ones, and those that the example `generate_mc` draws.

use std::path::{Path, PathBuf};
use std::process::Command;

use xtask::workspace::programs_folder;

use crate::process::must;

pub(super) const FAMILIES: [&str; 4] = ["F", "S", "A", "D"];
/// Shares of false edges.
pub(super) const RATES: [&str; 3] = ["0.1", "0.5", "0.9"];
const SEED: &str = "1";

/// The parameters of a generated instance.
#[derive(Clone, Copy)]
pub(super) struct Drawn {
    family: &'static str,
    pub(super) viewpoints: u64,
    rate: &'static str,
}

pub(super) struct Instance {
    pub(super) name: String,
    pub(super) path: PathBuf,
    pub(super) drawn: Option<Drawn>,
}

impl Instance {
    /// Writes the file of a generated instance.
    pub(super) fn generate(&self) -> anyhow::Result<()> {
        let Some(Drawn { family, viewpoints, rate }) = self.drawn else { return Ok(()) };
        let mut generate = Command::new(programs_folder().join("examples/generate_mc"));
        must(generate.args([family, &viewpoints.to_string(), rate, SEED]).arg(&self.path))?;
        Ok(())
    }
}

/// All instances. The generated ones share one file in the folder.
pub(super) fn instances(largest: u64, folder: &Path) -> anyhow::Result<Vec<Instance>> {
    let mut all = Vec::new();
    match std::env::var_os("POSECUT_SHARED_DATA") {
        Some(data) => {
            for path in glob::glob(&Path::new(&data).join("multicut/*.mc").to_string_lossy())? {
                let path = path?;
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                all.push(Instance { name, path, drawn: None });
            }
        }
        None => eprintln!("skipped: no data: multicut (set POSECUT_SHARED_DATA)"),
    }
    for viewpoints in [1000, 10_000, 100_000, 1_000_000].into_iter().filter(|size| *size <= largest) {
        for family in FAMILIES.into_iter().filter(|family| *family != "D" || viewpoints <= 100_000) {
            for rate in RATES {
                let name = format!("{family} n={viewpoints} {rate}");
                let drawn = Some(Drawn { family, viewpoints, rate });
                all.push(Instance { name, path: folder.join("instance.mc"), drawn });
            }
        }
    }
    Ok(all)
}

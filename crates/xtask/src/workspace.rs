//! Paths of the workspace, its programs and its data.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use serde::Deserialize;

/// The root of the workspace.
pub fn root() -> &'static Path {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.ancestors().nth(2).unwrap_or(own)
}

/// Cargo's target directory.
pub fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// The folder of the release programs.
pub fn programs_folder() -> PathBuf {
    target().join("release")
}

/// A release program of the workspace, by its name without `posecut-`.
pub fn program(name: &str) -> PathBuf {
    programs_folder().join(format!("posecut-{name}{}", std::env::consts::EXE_SUFFIX))
}

/// A path of the command line as it is from the root, for processes that run there.
///
/// # Errors
/// If there is no current directory.
pub fn from_root(path: &Path) -> anyhow::Result<PathBuf> {
    let path = std::path::absolute(path).with_context(|| format!("{}: cannot be found", path.display()))?;
    Ok(path.strip_prefix(root()).map_or_else(|_| path.clone(), Path::to_path_buf))
}

/// The folder of graphs and sessions that are not in the repository.
///
/// # Errors
/// If `POSECUT_SHARED_DATA` does not name it.
pub fn shared_data() -> anyhow::Result<PathBuf> {
    std::env::var_os("POSECUT_SHARED_DATA").map(PathBuf::from).context(
        "POSECUT_SHARED_DATA is not set; set it to the folder with g2o/, false_closures/, multicut/, nclt/ and radish/",
    )
}

#[derive(Deserialize)]
struct Manifest {
    package: Package,
}

#[derive(Deserialize)]
struct Package {
    name: String,
}

/// The names of all programs without `posecut-`, sorted: the crates named `posecut-NAME` that have a `src/main.rs`.
///
/// # Errors
/// If a Cargo.toml cannot be read.
pub fn programs() -> anyhow::Result<Vec<String>> {
    let mut names = Vec::new();
    let crates = root().join("crates");
    for entry in
        std::fs::read_dir(&crates).with_context(|| format!("{}: cannot be read", crates.display()))?
    {
        let folder = entry?.path();
        if !folder.join("src/main.rs").is_file() {
            continue;
        }
        let path = folder.join("Cargo.toml");
        let place = || format!("{}: cannot be used", path.display());
        let text = std::fs::read_to_string(&path).with_context(place)?;
        let manifest: Manifest = toml::from_str(&text).with_context(place)?;
        names.extend(manifest.package.name.strip_prefix("posecut-").map(str::to_owned));
    }
    if names.is_empty() {
        bail!("{}: has no program; run this in the workspace that it was built in", crates.display());
    }
    names.sort();
    Ok(names)
}

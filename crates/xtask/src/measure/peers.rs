//! Calls other libraries through small Python scripts.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context as _, bail};
use xtask::workspace::root;

/// The Python of an environment with these packages, which are installed if missing.
///
/// # Errors
/// If the packages cannot be installed.
pub(super) fn python(packages: &[&str]) -> anyhow::Result<PathBuf> {
    let script = root().join("scripts/python-environment.sh");
    let output =
        Command::new(&script).args(packages).output().with_context(|| script.display().to_string())?;
    if !output.status.success() {
        bail!(
            "{} cannot be installed in target/python; see scripts/python-environment.sh",
            packages.join(", ")
        );
    }

    Ok(PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()))
}

/// A script that prints one JSON object about a library.
pub(super) fn script(name: &str) -> PathBuf {
    root().join("scripts").join(format!("peer-{name}.py"))
}

//! A lock that allows one run at a time over the same tasks.

use std::fs::{File, TryLockError};
use std::path::Path;
use std::process::Stdio;

use anyhow::Context as _;
use posecut_stage::{info, warn};

/// A lock that a runner shares with the stages that it calls, by passing it as their standard input. If a runner is killed,
/// the next one therefore waits until the surviving stages have ended, and no two stages write the same file.
pub(crate) struct Lock(File);

impl Lock {
    /// Waits for the lock of a run whose first task is in this group.
    pub(crate) fn take(group: &str) -> anyhow::Result<Self> {
        let group = Path::new(group);
        let name = group.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let path = group.with_file_name(format!(".{name}.lock"));
        let place = || format!("{}: cannot be created", path.display());
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).with_context(place)?;
        }
        let file = File::options().read(true).append(true).create(true).open(&path).with_context(place)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                info!(
                    "another run, or a stage that it started, is still working here; waiting for the lock {}",
                    path.display()
                );
                file.lock().with_context(|| format!("{}: cannot be locked", path.display()))?;
            }
            Err(TryLockError::Error(error)) => {
                warn!(
                    "{}: cannot be locked ({error}); make sure that no other run is working here",
                    path.display()
                );
            }
        }
        Ok(Self(file))
    }

    /// The standard input of a stage: an empty file that carries the lock.
    pub(crate) fn stdin(&self) -> anyhow::Result<Stdio> {
        Ok(Stdio::from(self.0.try_clone().context("the lock cannot be shared")?))
    }
}

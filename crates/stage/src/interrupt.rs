//! Ctrl-C and termination leave no half-written file behind.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Temporary files being written now.
static TEMPORARY_FILES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Exit status after an interrupt, as shells have it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// While it lives, an interrupt deletes the file.
pub(crate) struct Guard(PathBuf);

pub(crate) fn delete_on_interrupt(path: &Path) -> Guard {
    TEMPORARY_FILES.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
    Guard(path.to_owned())
}

impl Drop for Guard {
    fn drop(&mut self) {
        TEMPORARY_FILES.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| *path != self.0);
    }
}

/// Installs the handler; without one (no signals on the platform) the system's default stays.
pub(crate) fn install() {
    let installed = ctrlc::set_handler(|| {
        for path in TEMPORARY_FILES.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
            let _ = std::fs::remove_file(&path).or_else(|_| std::fs::remove_dir_all(&path));
        }
        #[expect(clippy::exit, reason = "an interrupt ends the process; everything to tidy up is tidied up")]
        std::process::exit(INTERRUPTED);
    });
    if let Err(error) = installed {
        tracing::debug!("no interrupt handler: {error}");
    }
}
